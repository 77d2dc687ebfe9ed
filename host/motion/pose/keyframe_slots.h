// The keyframes' pictures on a device, and registrations against them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host/dic/device/ball.h"
#include "host/dic/device/ring.h"
#include "host/dic/device/sphere_search.h"
#include "host/dic/frames/device_frames.h"
#include "host/motion/ball_crop.h"
#include "host/opencl/engine.h"

namespace impactdic::motion {

// Keyframes' pictures that a device holds at a time.
inline constexpr int kKeyframePlaces = 8;

// Where frames are registered against keyframes: whoever has the frames on its device. The
// keyframes' pictures stand in the kKeyframePlaces slots from `first_slot` on.
class KeyframeSlots {
 public:
  // `engine` and `frames` must outlive the object.
  // `options.model`: kRigid of a flat ball (affine where it is compressed), or kSphere.
  KeyframeSlots(opencl::Engine& engine, dic::DeviceFrames& frames, int first_slot,
                const dic::BallOptions& options);

  // The slot of keyframe `index`; puts its picture there unless it is there, in place of the one
  // that has not been asked for longest. Good until kKeyframePlaces others were asked for.
  // `picture` is the part of its frame from `corner` on.
  int hold(std::int64_t index, const Frame& picture, const CropOrigin& corner);
  std::vector<BallMotion> measure(std::span<const BallTask> tasks, bool affine);
  dic::RingMotion turn(const RingTask& task);
  // Turns of a sphere, likeliest first.
  std::vector<dic::SphereTurn> turns(const SphereSearchTask& task);

 private:
  dic::DeviceFrames& frames_;
  int first_slot_;
  dic::BallRegistration rigid_, affine_;
  dic::RingRotation ring_;
  dic::SphereSearch search_;
  struct Place {
    std::int64_t index = -1, asked = 0;  // of its keyframe, −1: none; when it was asked for
  };
  std::array<Place, kKeyframePlaces> places_;
  std::int64_t asked_ = 0;
};

}  // namespace impactdic::motion
