#include "host/motion/pose/keyframe_slots.h"

#include <algorithm>

namespace impactdic::motion {
namespace {

dic::BallOptions affine(dic::BallOptions options) {
  options.model = dic::BallModel::kAffine;
  options.lit = false;
  return options;
}

}  // namespace

KeyframeSlots::KeyframeSlots(opencl::Engine& engine, dic::DeviceFrames& frames, int first_slot,
                             const dic::BallOptions& options)
    : frames_(frames),
      first_slot_(first_slot),
      rigid_(engine, options),
      affine_(engine, affine(options)),
      ring_(engine, {}),
      search_(engine) {}

int KeyframeSlots::hold(std::int64_t index, const Frame& picture, const CropOrigin& corner) {
  auto place = std::find_if(places_.begin(), places_.end(),
                            [&](const Place& held) { return held.index == index; });
  if (place == places_.end()) {
    place = std::min_element(places_.begin(), places_.end(),
                             [](const Place& a, const Place& b) { return a.asked < b.asked; });
    place->index = index;
    const dic::FramePart whole = {&picture, 0, 0, {corner.x, corner.y}};
    frames_.set(first_slot_ + static_cast<int>(place - places_.begin()), std::span(&whole, 1),
                picture.width(), picture.height());
  }
  place->asked = ++asked_;
  return first_slot_ + static_cast<int>(place - places_.begin());
}

std::vector<BallMotion> KeyframeSlots::measure(std::span<const BallTask> tasks, bool affine) {
  return (affine ? affine_ : rigid_).measure(frames_, tasks);
}

dic::RingMotion KeyframeSlots::turn(const RingTask& task) {
  return ring_.measure(frames_, std::span(&task, 1))[0];
}

std::vector<dic::SphereTurn> KeyframeSlots::turns(const SphereSearchTask& task) {
  return search_.find(frames_, task);
}

}  // namespace impactdic::motion
