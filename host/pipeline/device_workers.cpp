#include "host/pipeline/device_workers.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/base/stopwatch.h"
#include "host/circle/device/rim_follower.h"
#include "host/motion/estimators.h"
#include "host/motion/measure_pairs.h"
#include "host/opencl/engine.h"
#include "host/pipeline/rows/place_by_turns.h"

namespace impactdic::pipeline {
namespace {

// Whether one of the outlines of pair `i`, or of the frames beside it, is an ellipse, lost, or
// smaller than that of the free ball, as an ellipse's is that does not show.
bool near_contact(const TrackBatch& batch, std::size_t i, double radius_px) {
  constexpr double kSmaller = 0.985;
  const std::size_t end = std::min(i + 3, batch.frames.size());
  for (std::size_t k = i > 0 ? i - 1 : 0; k < end; ++k) {
    if (!batch.rows[k].circle_ok || !batch.shapes[k].is_circle()) return true;
    if (batch.circles[k].r_px < kSmaller * radius_px) return true;
  }
  return false;
}

// A GPU copies, computes and waits for the host at once; a CPU that is the device itself gains
// nothing from more batches in flight.
constexpr int kWorkersOfGpu = 12, kWorkersOfCpu = 1;
// Of all clips that are measured at once on a GPU: more of them only lock more of the host's
// memory, which its driver does for one at a time.
constexpr int kWorkersOfAllClips = 16, kFewestOfGpu = 2;
// Batches whose frames are registered together before the poses of the first of them are known: a
// launch takes as long for one frame as for a batch, and one batch after another would wait for it.
constexpr int kAheadOnGpu = 4;
// Batches that wait for a worker, so that none of those is idle while the oldest batch is finished.
constexpr std::size_t kWaiting = 2;
// Device memory of a pixel of a frame: picture, and two sets of B-splines with their planes.
constexpr std::size_t kBytesPerPixel = 4 + 2 * 16;
// Share of a device's memory that all workers may take.
constexpr double kMemoryShare = 0.5;
// A ball this far from where it was expected may leave the part of its frame about that.
constexpr double kAsExpected_px = 2;

int workers_of(const opencl::Engine& engine) {
  return engine.device().is_gpu ? kWorkersOfGpu : kWorkersOfCpu;
}

// The same, less those that other clips have on the device.
int free_workers_of(const opencl::Engine& engine) {
  if (!engine.device().is_gpu) return kWorkersOfCpu;
  const int others = engine.count() - 1;
  return std::clamp(kWorkersOfAllClips - others, kFewestOfGpu, kWorkersOfGpu);
}

// A device, and an engine of a worker's own on it.
struct OwnEngine {
  const opencl::Engine* device;
  std::unique_ptr<opencl::Engine> engine;
};

// Of every device as many as are of use and free. Neighbours are on different devices, so that a
// short clip reaches all of them.
std::vector<OwnEngine> take_engines(std::span<opencl::Engine* const> devices, std::int64_t useful) {
  static std::mutex taking;  // what is free is counted and taken in one step
  const std::lock_guard<std::mutex> lock(taking);
  std::vector<std::int64_t> free;
  for (const opencl::Engine* device : devices) {
    free.push_back(std::min<std::int64_t>(useful, free_workers_of(*device)));
  }
  std::vector<OwnEngine> own;
  for (std::int64_t k = 0; k < *std::max_element(free.begin(), free.end()); ++k) {
    for (std::size_t d = 0; d < devices.size(); ++d) {
      if (k < free[d]) own.push_back({devices[d], devices[d]->beside()});
    }
  }
  return own;
}

int slots_of(const opencl::Device& device, int workers, int width, int height, int batch) {
  const double pixels = static_cast<double>(width) * height;
  const double by_memory = kMemoryShare * static_cast<double>(device.global_memory_bytes) /
                           (pixels * kBytesPerPixel * workers);
  // The planes of all slots are one buffer: three floats a pixel.
  const double by_buffer = static_cast<double>(device.max_allocation_bytes) / (pixels * 12.5) - 2;
  return static_cast<int>(std::clamp(std::min(by_memory, by_buffer), 2.0, batch + 1.0));
}

}  // namespace

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

// A batch's use of a worker: batches get workers in their order, so that none holds one while
// another before it, whose poses it waits for, has none.
class DeviceWorkers::Use {
 public:
  Use(DeviceWorkers& workers, std::int64_t number) : workers_(workers) {
    std::unique_lock<std::mutex> lock(workers.mutex_);
    workers.changed_.wait(lock,
                          [&] { return workers.started_ == number && !workers.free_.empty(); });
    worker_ = workers.free_.front();
    workers.free_.pop_front();
    ++workers.started_;
    lock.unlock();
    workers.changed_.notify_all();
  }
  ~Use() {
    {
      const std::lock_guard<std::mutex> lock(workers_.mutex_);
      workers_.free_.push_back(worker_);
    }
    workers_.changed_.notify_all();
  }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;
  Worker& worker() { return *worker_; }

 private:
  DeviceWorkers& workers_;
  Worker* worker_ = nullptr;
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

DeviceWorkers::DeviceWorkers(std::span<opencl::Engine* const> engines,
                             const motion::EstimatorOptions& options, const Clip& clip, int ahead,
                             CircleWork circles, std::function<bool()> cancelled,
                             StageTimes* times, const WorkerStages& stages)
    : radius_px_(clip.radius_px),
      cancelled_(std::move(cancelled)),
      crop_(options, clip.radius_px, clip.width, clip.height),
      circles_(std::move(circles)),
      times_(times),
      stages_(stages),
      aim_(clip.radius_px, crop_, options),
      options_(options),
      batch_(clip.batch),
      ahead_(ahead) {
  if (ahead_ == 0) {
    const bool gpus = std::all_of(engines.begin(), engines.end(), [](const opencl::Engine* engine) {
      return engine->device().is_gpu;
    });
    ahead_ = gpus ? kAheadOnGpu : 1;
  }
  if (options.estimator == Estimator::kBall) {
    keyframes_.emplace(aim_, options.sphere_radius_sd_px);
    forecast_.emplace(aim_);
  } else {
    ahead_ = 1;
  }
  const auto shares = static_cast<std::int64_t>(engines.size());
  const std::int64_t useful = std::max<std::int64_t>(1, (clip.batches + shares - 1) / shares);
  std::vector<std::future<std::unique_ptr<Worker>>> opening;
  for (OwnEngine& own : take_engines(engines, useful)) {
    opening.push_back(std::async(std::launch::async, [&, own = std::move(own)]() mutable {
      const int slots = slots_of(own.device->device(), workers_of(*own.device), crop_.width(),
                                 crop_.height(), batch_);
      return std::make_unique<Worker>(std::move(own.engine), options, aim_, radius_px_, slots);
    }));
  }
  for (auto& worker : opening) {
    free_.push_back(workers_.emplace_back(worker.get()).get());
    workers_.back()->engine->stop_when([this] { return is_cancelled(); });
  }
  // A batch that goes to its device in parts leaves no part there for later.
  for (const auto& worker : workers_) {
    if (worker->slots <= batch_) ahead_ = 1;
  }
}

DeviceWorkers::~DeviceWorkers() {
  for (Flight& flight : flights_) flight.done.wait();
}

std::span<const Window> DeviceWorkers::grid() const { return workers_.front()->estimator->grid(); }

int DeviceWorkers::count(std::span<opencl::Engine* const> engines) {
  int workers = 0;
  for (const opencl::Engine* engine : engines) workers += workers_of(*engine);
  return workers;
}

DeviceWorkers::Batch DeviceWorkers::submit(const Batch& batch) {
  Batch finished;
  if (flights_.size() == workers_.size() + kWaiting) finished = take();
  const std::int64_t number = submitted_++;
  batch->resumable = place_in_group(*batch) == ahead_ - 1;
  flights_.push_back({batch, std::async(std::launch::async, [this, batch, number] {
                        Turn placing(*this, placed_, number);
                        Turn planning(*this, planned_, number);
                        Use use(*this, number);
                        return measure(use.worker(), *batch, planning, placing);
                      })});
  return finished;
}

DeviceWorkers::Batch DeviceWorkers::take() {
  if (flights_.empty()) return nullptr;
  Flight flight = std::move(flights_.front());
  flights_.pop_front();
  return flight.done.get() ? flight.batch : nullptr;
}

std::int64_t DeviceWorkers::place_in_group(const TrackBatch& batch) const {
  return batch.own->first_index / batch_ % ahead_;
}

// Once it was true it stays so for all: a batch behind a dropped one would leave a gap in the rows.
bool DeviceWorkers::is_cancelled() {
  const std::lock_guard<std::mutex> lock(mutex_);
  dropping_ = dropping_ || (cancelled_ && cancelled_());
  return dropping_;
}

bool DeviceWorkers::measure(Worker& worker, TrackBatch& batch, Turn& planning, Turn& placing) {
  try {
    return measure_parts(worker, batch, planning, placing);
  } catch (const opencl::Stopped&) {
    return false;
  }
}

bool DeviceWorkers::measure_parts(Worker& worker, TrackBatch& batch, Turn& planning,
                                  Turn& placing) {
  Origins origins;
  if (batch.circles_left) origins = complete_circles(worker, batch);
  const bool is_there = !origins.empty();
  const std::size_t count = batch.frames.size();
  for (std::size_t i = origins.size(); i < count; ++i) {
    origins.push_back(crop_.about(ball(batch.circles[i])));
  }
  batch.pairs.resize(count);
  batch.measured.assign(count, false);
  const auto slots = static_cast<std::size_t>(worker.slots);
  std::vector<motion::TurnedCentre> told;
  // A part begins with the last frame of the one before.
  for (std::size_t first = 0; first + 1 < count; first += slots - 1) {
    const std::size_t frames = std::min(slots, count - first);
    if (is_cancelled()) return false;
    const auto cut = std::span(origins).subspan(first, frames);
    measure_part(worker, batch, first, cut, is_there);
    if (!keyframes_) continue;
    if (is_cancelled()) return false;
    motion::Keyframes::Ahead ahead;
    ahead.frames = chained(batch, first, cut);
    if (ahead_ > 1) register_ahead(worker, batch, ahead, planning, placing);
    if (worker.centres) {
      for (motion::TurnedCentre centre : worker.centres->measure(ahead.frames)) {
        centre.frame += first;
        told.push_back(centre);
      }
    }
    placing.wait();
    if (is_cancelled()) return false;
    place_part(worker, batch, first, ahead);
  }
  if (keyframes_) placing.end();  // its turn has come by now
  place_by_turns(batch.rows, batch.pairs, told, options_);
  return true;
}

void DeviceWorkers::register_ahead(Worker& worker, const TrackBatch& batch,
                                   motion::Keyframes::Ahead& ahead, Turn& planning, Turn& placing) {
  planning.wait();
  if (is_cancelled()) return;  // the batch before may have left no forecast
  if (place_in_group(batch) == 0) {
    placing.wait();
    forecast_->begin(keyframes_->memory());
  }
  const StageTimes::Scope timed(times_, stages_.ahead);
  forecast_->plan(ahead);
  planning.end();
  ahead.motions =
      aim_.measure(std::span(ahead.frames).subspan(1), ahead.near, ahead.plan, *worker.keyframes);
}

Circle DeviceWorkers::ball(const Circle& circle) const {
  return motion::about_centre(circle, options_.perspective);
}

void DeviceWorkers::upload(Worker& worker, std::span<const Frame* const> frames,
                           std::span<const motion::CropOrigin> origins) {
  const StageTimes::Scope timed(times_, stages_.upload);
  std::vector<dic::FramePart> parts;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    parts.push_back({frames[k], origins[k].x, origins[k].y});
  }
  worker.frames.set(0, parts, crop_.width(), crop_.height());
}

DeviceWorkers::Origins DeviceWorkers::complete_circles(Worker& worker, TrackBatch& batch) {
  batch.circles_left = false;
  std::vector<const Frame*> frames = batch.frames;  // that of the batch before, where there is one
  const std::size_t before = frames.size();
  for (const Frame& frame : batch.own->frames) frames.push_back(&frame);
  if (frames.size() > static_cast<std::size_t>(worker.slots)) {
    circles_.complete(batch, {});
    return {};
  }
  const std::vector<circle::CirclePrior> expected = circles_.expected(batch);
  std::vector<Circle> circles = batch.circles;
  for (const circle::CircleFit& fit : batch.fits) circles.push_back(fit.circle);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    circles[before + batch.plan.left[k].frame] = expected[k].predicted;
  }
  Origins origins;
  for (const Circle& circle : circles) origins.push_back(crop_.about(ball(circle)));
  upload(worker, frames, origins);
  {
    const StageTimes::Scope timed(times_, stages_.circles);
    std::vector<circle::RimToFollow> rims;
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const std::size_t i = before + batch.plan.left[k].frame;
      const auto [x, y] = origins[i];
      rims.push_back({frames[i], static_cast<int>(i), x, y, expected[k]});
    }
    if (!worker.rims) worker.rims.emplace(*worker.engine, circles_.options);
    circles_.complete(batch, worker.rims->follow(worker.frames, rims));
  }
  // One that is elsewhere, as behind an impact, may be cut by its part.
  for (std::size_t i = 0; i < circles.size(); ++i) {
    const Circle& found = batch.circles[i];
    const double off_px =
        std::hypot(found.cx_px - circles[i].cx_px, found.cy_px - circles[i].cy_px);
    if (off_px > kAsExpected_px) return {};
  }
  return origins;
}

void DeviceWorkers::measure_part(Worker& worker, TrackBatch& batch, std::size_t first,
                                 std::span<const motion::CropOrigin> origins, bool is_there) {
  const std::size_t count = origins.size();
  std::vector<motion::PairMotion> pairs;
  std::vector<std::size_t> which;
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const std::size_t i = first + k;
    if (!batch.rows[i].circle_ok || !batch.rows[i + 1].circle_ok) continue;
    motion::PairMotion& pair = pairs.emplace_back();
    pair.first_slot = static_cast<int>(k);
    pair.second_slot = static_cast<int>(k + 1);
    pair.first = ball(batch.circles[i]);
    pair.second = ball(batch.circles[i + 1]);
    pair.shape = batch.shapes[i];
    pair.second_shape = batch.shapes[i + 1];
    pair.near_contact = near_contact(batch, i, radius_px_);
    motion::into_crops(pair, origins[k], origins[k + 1]);
    which.push_back(k);
  }
  // A ball without a neighbour may still be placed against a keyframe.
  const auto rows = std::span(batch.rows).subspan(first, count);
  const bool any_ball =
      std::any_of(rows.begin(), rows.end(), [](const TrackRow& row) { return row.circle_ok; });
  if (which.empty() && !(keyframes_ && any_ball)) return;
  if (!is_there) upload(worker, std::span(batch.frames).subspan(first, count), origins);
  const double fits_before = worker.estimator->fit_seconds();
  const Stopwatch watch;
  measure_pairs(*worker.estimator, radius_px_, pairs);
  if (times_ != nullptr) {
    const double fits = worker.estimator->fit_seconds() - fits_before;
    times_->add(stages_.fit, fits);
    times_->add(stages_.device, watch.seconds() - fits);
  }
  for (std::size_t k = 0; k < which.size(); ++k) {
    motion::out_of_crops(pairs[k], origins[which[k]], origins[which[k] + 1]);
    batch.pairs[first + which[k]] = std::move(pairs[k]);
    batch.measured[first + which[k]] = true;
  }
}

std::vector<motion::ChainedFrame> DeviceWorkers::chained(
    const TrackBatch& batch, std::size_t first,
    std::span<const motion::CropOrigin> origins) const {
  std::vector<motion::ChainedFrame> frames;
  for (std::size_t k = 0; k < origins.size(); ++k) {
    const std::size_t i = first + k;
    motion::ChainedFrame& frame = frames.emplace_back();
    frame.index = batch.first_index + static_cast<std::int64_t>(i);
    frame.circle_ok = batch.rows[i].circle_ok;
    frame.circle = ball(batch.circles[i]);
    const double circle_sd_px = std::hypot(batch.rows[i].cx_sd_px, batch.rows[i].cy_sd_px);
    if (circle_sd_px > 0) frame.circle_sd_px = circle_sd_px / std::sqrt(2.0);
    frame.shape = batch.shapes[i];
    frame.frame = batch.frames[i];
    if (batch.measured[i]) frame.next = &batch.pairs[i].motion;
    frame.slot = static_cast<int>(k);
    frame.origin = origins[k];
  }
  return frames;
}

void DeviceWorkers::place_part(Worker& worker, TrackBatch& batch, std::size_t first,
                               const motion::Keyframes::Ahead& ahead) {
  const StageTimes::Scope timed(times_, stages_.poses);
  const std::vector<BodyPose> poses = keyframes_->follow(ahead, *worker.keyframes);
  for (std::size_t k = 0; k < poses.size(); ++k) batch.rows[first + k].pose = poses[k];
  batch.keyframes = keyframes_->memory();
}

}  // namespace impactdic::pipeline
