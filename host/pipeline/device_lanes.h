// The motions of batches of frames, several batches in flight: while one lane's frames travel to
// its device, another's kernels run and a third's fits are made.
#pragma once

#include <condition_variable>
#include <deque>
#include <future>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "host/base/stage_times.h"
#include "host/dic/frames/device_frames.h"
#include "host/motion/keyframes.h"
#include "host/pipeline/track_batch.h"

namespace impactdic::pipeline {

// Stages that the lanes are timed under.
struct LaneStages {
  int upload = 0, device = 0, fit = 0, poses = 0;
};

class DeviceLanes {
 public:
  using Batch = std::shared_ptr<TrackBatch>;

  // Every engine gets the same number of lanes, each with a queue, frames and an estimator of its
  // own. `batch` frames at most come at a time; they go to the device in as many parts as its
  // memory asks for. The engines and `times` (may be null) must outlive the lanes.
  DeviceLanes(std::span<opencl::Engine* const> engines, const motion::EstimatorOptions& options,
              double radius_px, int width, int height, int batch, StageTimes* times,
              const LaneStages& stages);
  ~DeviceLanes();

  std::span<const Window> grid() const;
  double radius_px() const { return radius_px_; }
  // Lanes that `engines` will get: as many batches are measured at once.
  static int count(std::span<opencl::Engine* const> engines);

  // Poses go on from those of an earlier run: see Keyframes. Before the first batch.
  void restore(const motion::Keyframes::Memory& memory,
               const std::function<Frame(std::int64_t)>& read) {
    if (keyframes_) keyframes_->restore(memory, read);
  }

  // Has a lane measure the pairs of `batch`, and with the ball estimator its frames' poses. Where
  // all lanes are busy it waits for the oldest batch and returns that, else nullptr. What a lane
  // throws comes out here or from `take`.
  Batch submit(Batch batch);
  // Waits for the oldest batch; nullptr where none is left.
  Batch take();

 private:
  struct Lane;
  class Turn;
  class Use;
  void measure(Lane& lane, TrackBatch& batch, Turn& turn);
  void measure_part(Lane& lane, TrackBatch& batch, std::size_t first, std::size_t count);
  void place_part(Lane& lane, TrackBatch& batch, std::size_t first, std::size_t count);

  double radius_px_;
  motion::BallCrop crop_;
  StageTimes* times_;
  LaneStages stages_;
  std::vector<std::unique_ptr<Lane>> lanes_;
  struct Flight {
    Batch batch;
    std::future<void> done;
  };
  std::deque<Flight> flights_;  // oldest first
  // Poses are a chain through all frames: batches come to it one after the other.
  std::optional<motion::Keyframes> keyframes_;
  std::int64_t submitted_ = 0;
  std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::deque<Lane*> free_;
  std::int64_t started_ = 0, placed_ = 0;  // batches that have had a lane, and their poses
};

}  // namespace impactdic::pipeline
