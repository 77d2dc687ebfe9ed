#include <algorithm>
#include <cmath>

#include "host/dic/device/ring.h"
#include "host/motion/estimators.h"

namespace impactdic::motion {
namespace {

// The dissertation's circular window (section 2.4.1): the field says where the ball went, rings
// about the measured centres how far it turned.
class RingEstimator : public MotionEstimator {
 public:
  RingEstimator(opencl::Engine& engine, const EstimatorOptions& options, double radius_px,
                dic::DeviceFrames& frames)
      : options_(options),
        radius_px_(radius_px),
        field_(make_field_estimator(engine, options, radius_px, frames)),
        frames_(frames),
        ring_(engine, {}) {}

  std::span<const Window> grid() const override { return field_->grid(); }
  double fit_seconds() const override { return field_->fit_seconds(); }

  void measure(std::span<PairMotion> pairs) override {
    // The rings first: what they find is where the windows look.
    std::vector<RingTask> tasks;
    for (const PairMotion& pair : pairs) tasks.push_back(ring_task(pair, radius_px_));
    const std::vector<dic::RingMotion> turns = ring_.measure(frames_, tasks);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (turns[i].status == WindowStatus::kOk) pairs[i].guess_rot_rad = turns[i].rot_rad;
    }
    field_->measure(pairs);
    for (std::size_t i = 0; i < pairs.size(); ++i) take_over(turns[i], pairs[i]);
  }

 private:
  static void take_over(const dic::RingMotion& turn, PairMotion& pair) {
    if (turn.status != WindowStatus::kOk) {
      pair.motion.ok = false;
      pair.status = turn.status == WindowStatus::kNoTexture   ? TrackStatus::kNoTexture
                    : turn.status == WindowStatus::kOutOfView ? TrackStatus::kOutOfView
                                                              : TrackStatus::kLowCorrelation;
      return;
    }
    pair.motion.rot_rad = turn.rot_rad;
    pair.motion.rot_sd_rad = turn.rot_sd_rad;
  }

  EstimatorOptions options_;
  double radius_px_;
  std::unique_ptr<MotionEstimator> field_;
  dic::DeviceFrames& frames_;
  dic::RingRotation ring_;
};

}  // namespace

RingTask ring_task(const PairMotion& pair, double radius_px) {
  // Near the centre a ring has few pixels; near the rim lies what is not the ball.
  constexpr double kInnerShare = 0.17, kRimPx = 5, kFreePx = 3;
  const double usual = kInnerShare * radius_px;
  const double rim = std::max(radius_px - kRimPx, 0.5 * radius_px);  // of a ball of some pixels
  // What hides a part of the ball does not turn with it: the rings shrink with the free part
  // (section 2.4.1), towards the centre too, as long as some of them is left.
  constexpr double kLeastFreePx = 10, kInnerOfFree = 0.4;
  const double free = std::min(pair.first.free_px, pair.second.free_px) - kFreePx;
  RingTask task{};
  task.first = pair.first_slot;
  task.second = pair.second_slot;
  task.cx_first = static_cast<float>(pair.first.cx_px);
  task.cy_first = static_cast<float>(pair.first.cy_px);
  task.cx_second = static_cast<float>(pair.second.cx_px);
  task.cy_second = static_cast<float>(pair.second.cy_px);
  const double outer = free > kLeastFreePx ? std::min(rim, free) : rim;
  task.inner = static_cast<float>(std::min(usual, kInnerOfFree * outer));
  task.outer = static_cast<float>(outer);
  return task;
}

std::unique_ptr<MotionEstimator> make_ring_estimator(opencl::Engine& engine,
                                                     const EstimatorOptions& options,
                                                     double radius_px, dic::DeviceFrames& frames) {
  return std::make_unique<RingEstimator>(engine, options, radius_px, frames);
}

}  // namespace impactdic::motion
