// The motions of batches of frames, several batches in flight: while one worker's frames travel to
// its device, another's kernels run and a third's fits are made.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "host/base/stage_times.h"
#include "host/dic/frames/device_frames.h"
#include "host/motion/pose/keyframes.h"
#include "host/motion/pose/pose_forecast.h"
#include "host/pipeline/track_batch.h"

namespace impactdic::pipeline {

// Stages that the workers are timed under.
struct WorkerStages {
  int upload = 0, circles = 0, device = 0, fit = 0, ahead = 0, poses = 0;
};

class DeviceWorkers {
 public:
  using Batch = std::shared_ptr<TrackBatch>;

  // What is to be measured: `width` × `height` frames of a ball of `radius_px`, at most `batch` at
  // a time; about `batches` of them come.
  struct Clip {
    double radius_px = 0;
    int width = 0, height = 0, batch = 0;
    std::int64_t batches = 0;
  };
  // Engines get as many workers as suit them, or fewer where there is less to do, each with a
  // queue, frames and an estimator of its own. Batches go to the device in as many parts as its
  // memory asks for. `ahead`: batches whose frames are registered against keyframes before the
  // poses of the first of them are known; 1: none is, 0: as suits the devices. Poses depend on it
  // by a small part of their errors. Once `cancelled` (may be empty) says so, no work is begun any
  // more: a batch that is not done is dropped, and with it all behind it. The engines and `times`
  // (may be null) must outlive the workers.
  DeviceWorkers(std::span<opencl::Engine* const> engines, const motion::EstimatorOptions& options,
                const Clip& clip, int ahead, CircleWork circles, std::function<bool()> cancelled,
                StageTimes* times, const WorkerStages& stages);
  ~DeviceWorkers();

  std::span<const Window> grid() const;
  double radius_px() const { return radius_px_; }
  // Whether all of them follow such circles of a clip of so many frames: GPUs do of a long one, and
  // any where that is `wanted`.
  static bool follow_circles(std::span<opencl::Engine* const> engines,
                             const circle::CircleOptions& options, std::int64_t frames,
                             std::optional<bool> wanted);
  // Workers that `engines` will get: as many batches are measured at once.
  static int count(std::span<opencl::Engine* const> engines);

  // Poses go on from those of an earlier run: see Keyframes. Before the first batch.
  void restore(const motion::Keyframes::Memory& memory,
               const std::function<Frame(std::int64_t)>& read) {
    if (keyframes_) keyframes_->restore(memory, read);
  }

  // Has a worker measure the pairs of `batch`, and with the ball estimator its frames' poses. Where
  // all workers are busy it waits for the oldest batch and returns that, else nullptr. What a
  // worker throws comes out here or from `take`.
  Batch submit(const Batch& batch);
  // Waits for the oldest batch; nullptr where none is left, or it was dropped.
  Batch take();

 private:
  Circle ball(const Circle& circle) const;  // about its centre
  struct Worker;
  class Turn;
  class Use;
  // False where the batch was dropped.
  bool measure(Worker& worker, TrackBatch& batch, Turn& planning, Turn& placing);
  bool measure_parts(Worker& worker, TrackBatch& batch, Turn& planning, Turn& placing);
  bool is_cancelled();
  // The parts of a batch's frames that go to the device.
  typedef std::vector<motion::CropOrigin> Origins;
  // Completes the circles of a batch that has left them, its frames in the worker's slots where
  // they all fit in. Returns where they were cut, empty where they are not there.
  Origins complete_circles(Worker& worker, TrackBatch& batch);
  void upload(Worker& worker, std::span<const Frame* const> frames,
              std::span<const motion::CropOrigin> origins);
  // `origins`: of the part's frames; `is_there`: whether they are in the slots.
  void measure_part(Worker& worker, TrackBatch& batch, std::size_t first,
                    std::span<const motion::CropOrigin> origins, bool is_there);
  // Registers the batch's frames against keyframes as soon as it is known about where they are.
  void register_ahead(Worker& worker, const TrackBatch& batch, motion::Keyframes::Ahead& ahead,
                      Turn& planning, Turn& placing);
  void place_part(Worker& worker, TrackBatch& batch, std::size_t first,
                  const motion::Keyframes::Ahead& ahead);
  std::vector<motion::ChainedFrame> chained(const TrackBatch& batch, std::size_t first,
                                            std::span<const motion::CropOrigin> origins) const;
  // 0 of a group's first batch.
  std::int64_t place_in_group(const TrackBatch& batch) const;

  double radius_px_;
  std::function<bool()> cancelled_;
  motion::BallCrop crop_;
  CircleWork circles_;
  StageTimes* times_;
  WorkerStages stages_;
  std::vector<std::unique_ptr<Worker>> workers_;
  struct Flight {
    Batch batch;
    std::future<bool> done;  // whether it was measured
  };
  std::deque<Flight> flights_;  // oldest first
  // Poses are a chain through all frames: batches come to it one after the other. So they do to the
  // forecast, before: it begins with every group of `ahead_` batches from what is known then.
  std::optional<motion::Keyframes> keyframes_;
  std::optional<motion::PoseForecast> forecast_;
  motion::KeyframeAim aim_;
  motion::EstimatorOptions options_;
  int batch_, ahead_;
  std::int64_t submitted_ = 0;
  std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::deque<Worker*> free_;
  // Batches that have had a worker, a forecast, and their poses.
  std::int64_t started_ = 0, planned_ = 0, placed_ = 0;
  bool dropping_ = false;
};

}  // namespace impactdic::pipeline
