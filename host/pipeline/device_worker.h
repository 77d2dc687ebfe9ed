// A worker of DeviceWorkers, and a batch's turn among others. Internal to host/pipeline.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "host/circle/device/rim_follower.h"
#include "host/motion/estimators.h"
#include "host/motion/pose/turned_centres.h"
#include "host/opencl/engine.h"
#include "host/pipeline/device_workers.h"

namespace impactdic::pipeline {

// The slots of the frames, and behind them those of the keyframes.
struct DeviceWorkers::Worker {
  std::unique_ptr<opencl::Engine> engine;
  int slots;
  dic::DeviceFrames frames;
  std::unique_ptr<motion::MotionEstimator> estimator;
  std::optional<motion::KeyframeSlots> keyframes;  // with the ball estimator
  std::optional<motion::TurnedCentres> centres;    // of a sphere
  std::optional<circle::RimFollower> rims;         // once circles are left to it

  Worker(std::unique_ptr<opencl::Engine> own, const motion::EstimatorOptions& options,
         const motion::KeyframeAim& aim, double radius_px, int count)
      : engine(std::move(own)),
        slots(count),
        frames(*engine, count + motion::kKeyframePlaces),
        estimator(motion::make_motion_estimator(*engine, options, radius_px, frames)) {
    if (options.estimator != Estimator::kBall) return;
    keyframes.emplace(*engine, frames, count, motion::body_options(options));
    if (options.sphere) centres.emplace(*engine, frames, aim, motion::body_options(options));
  }
};

// A batch's turn at what comes in order, the forecasts or the poses: comes when all batches before
// have had theirs, and is over with `end` or with the object.
class DeviceWorkers::Turn {
 public:
  // `served`: of `workers`, the batches that have had theirs.
  Turn(DeviceWorkers& workers, std::int64_t& served, std::int64_t number)
      : workers_(workers), served_(served), number_(number) {}
  ~Turn() { end(); }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

  void wait() {
    std::unique_lock<std::mutex> lock(workers_.mutex_);
    workers_.changed_.wait(lock, [this] { return served_ == number_; });
  }
  void end() {
    if (over_) return;
    over_ = true;
    wait();
    {
      const std::lock_guard<std::mutex> lock(workers_.mutex_);
      ++served_;
    }
    workers_.changed_.notify_all();
  }

 private:
  DeviceWorkers& workers_;
  std::int64_t& served_;
  std::int64_t number_;
  bool over_ = false;
};

}  // namespace impactdic::pipeline
