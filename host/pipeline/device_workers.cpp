#include "host/pipeline/device_workers.h"

#include <algorithm>
#include <utility>

#include "host/motion/estimators.h"
#include "host/opencl/engine.h"
#include "host/pipeline/device_worker.h"

namespace impactdic::pipeline {
namespace {

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

DeviceWorkers::DeviceWorkers(std::span<opencl::Engine* const> engines,
                             const motion::EstimatorOptions& options, const Clip& clip, int ahead,
                             CircleWork circles, std::function<bool()> cancelled, StageTimes* times,
                             const WorkerStages& stages)
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

bool DeviceWorkers::follow_circles(std::span<opencl::Engine* const> engines,
                                   const circle::CircleOptions& options, std::int64_t frames,
                                   std::optional<bool> wanted) {
  const bool is_long = frames >= circle::RimFollower::kLongClip;
  return std::all_of(engines.begin(), engines.end(), [&](const opencl::Engine* engine) {
    const opencl::Device& device = engine->device();
    return wanted.value_or(device.is_gpu && is_long) &&
           circle::RimFollower::serves(device, options);
  });
}

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

}  // namespace impactdic::pipeline
