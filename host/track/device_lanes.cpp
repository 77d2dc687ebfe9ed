#include "host/track/device_lanes.h"

#include <algorithm>
#include <utility>

#include "host/base/stopwatch.h"
#include "host/opencl/engine.h"

namespace impactdic {
namespace {

// A GPU copies, computes and waits for the host at once; a CPU that is the device itself gains
// nothing from more batches in flight.
constexpr int kLanesOfGpu = 6, kLanesOfCpu = 1;
// Device memory of a pixel of a frame: picture, and two sets of B-splines with their planes.
constexpr std::size_t kBytesPerPixel = 4 + 2 * 16;
// Share of a device's memory that all lanes may take.
constexpr double kMemoryShare = 0.5;

int lanes_of(const Engine& engine) { return engine.device().is_gpu ? kLanesOfGpu : kLanesOfCpu; }

int slots_of(const DeviceInfo& device, int lanes, int width, int height, int batch) {
  const double pixels = static_cast<double>(width) * height;
  const double by_memory = kMemoryShare * static_cast<double>(device.global_memory_bytes) /
                           (pixels * kBytesPerPixel * lanes);
  // The planes of all slots are one buffer: three floats a pixel.
  const double by_buffer = static_cast<double>(device.max_allocation_bytes) / (pixels * 12.5) - 2;
  return static_cast<int>(std::clamp(std::min(by_memory, by_buffer), 2.0, batch + 1.0));
}

}  // namespace

struct DeviceLanes::Lane {
  std::unique_ptr<Engine> engine;
  DeviceFrames frames;
  std::unique_ptr<MotionEstimator> estimator;

  Lane(std::unique_ptr<Engine> own, const EstimatorOptions& options, double radius_px, int slots)
      : engine(std::move(own)),
        frames(*engine, slots),
        estimator(make_motion_estimator(*engine, options, radius_px, frames)) {}
};

DeviceLanes::DeviceLanes(std::span<Engine* const> engines, const EstimatorOptions& options,
                         double radius_px, int width, int height, int batch, StageTimes* times,
                         const LaneStages& stages)
    : radius_px_(radius_px), times_(times), stages_(stages) {
  int most = 0;
  for (const Engine* engine : engines) most = std::max(most, lanes_of(*engine));
  // Neighbouring lanes are on different devices, so that a short clip reaches all of them.
  for (int k = 0; k < most; ++k) {
    for (const Engine* engine : engines) {
      const int lanes = lanes_of(*engine);
      if (k >= lanes) continue;
      lanes_.push_back(
          std::make_unique<Lane>(engine->beside(), options, radius_px,
                                 slots_of(engine->device(), lanes, width, height, batch)));
    }
  }
}

DeviceLanes::~DeviceLanes() {
  for (Flight& flight : flights_) flight.done.wait();
}

std::span<const Window> DeviceLanes::grid() const { return lanes_.front()->estimator->grid(); }

int DeviceLanes::count(std::span<Engine* const> engines) {
  int lanes = 0;
  for (const Engine* engine : engines) lanes += lanes_of(*engine);
  return lanes;
}

DeviceLanes::Batch DeviceLanes::submit(Batch batch) {
  Batch finished;
  if (flights_.size() == lanes_.size()) finished = take();
  Lane& lane = *lanes_[next_];
  next_ = (next_ + 1) % lanes_.size();
  flights_.push_back(
      {batch, std::async(std::launch::async, [this, &lane, batch] { measure(lane, *batch); })});
  return finished;
}

DeviceLanes::Batch DeviceLanes::take() {
  if (flights_.empty()) return nullptr;
  Flight flight = std::move(flights_.front());
  flights_.pop_front();
  flight.done.get();
  return flight.batch;
}

void DeviceLanes::measure(Lane& lane, TrackBatch& batch) {
  const std::size_t count = batch.frames.size();
  batch.pairs.resize(count);
  batch.measured.assign(count, false);
  const auto slots = static_cast<std::size_t>(lane.frames.slots());
  // A part begins with the last frame of the one before.
  for (std::size_t first = 0; first + 1 < count; first += slots - 1) {
    const std::size_t frames = std::min(slots, count - first);
    std::vector<PairMotion> pairs;
    std::vector<std::size_t> which;
    for (std::size_t k = 0; k + 1 < frames; ++k) {
      const std::size_t i = first + k;
      if (!batch.rows[i].circle_ok || !batch.rows[i + 1].circle_ok) continue;
      PairMotion& pair = pairs.emplace_back();
      pair.first_slot = static_cast<int>(k);
      pair.second_slot = static_cast<int>(k + 1);
      pair.first = batch.circles[i];
      pair.second = batch.circles[i + 1];
      which.push_back(i);
    }
    if (which.empty()) continue;
    {
      const StageTimes::Scope timed(times_, stages_.upload);
      lane.frames.set(0, std::span(batch.frames).subspan(first, frames));
    }
    const double fits_before = lane.estimator->fit_seconds();
    const Stopwatch watch;
    measure_pairs(*lane.estimator, radius_px_, pairs);
    if (times_ != nullptr) {
      const double fits = lane.estimator->fit_seconds() - fits_before;
      times_->add(stages_.fit, fits);
      times_->add(stages_.device, watch.seconds() - fits);
    }
    for (std::size_t k = 0; k < which.size(); ++k) {
      batch.pairs[which[k]] = std::move(pairs[k]);
      batch.measured[which[k]] = true;
    }
  }
}

}  // namespace impactdic
