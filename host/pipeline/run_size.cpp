#include "host/pipeline/run_size.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <thread>

#include "host/opencl/engine.h"

namespace impactdic::pipeline {
namespace {

// Frames are handed on in batches of this size.
constexpr std::size_t kBatchBytes = std::size_t{16} << 20;
constexpr int kFewest = 8, kMost = 64;

}  // namespace

int frames_in_batch(const TrackOptions& options, int bits) {
  if (options.batch > 0) return options.batch;
  const std::size_t bytes =
      static_cast<std::size_t>(options.roi.width) * options.roi.height * (bits > 8 ? 2 : 1);
  const int usual = static_cast<int>(
      std::clamp<std::size_t>(kBatchBytes / std::max<std::size_t>(bytes, 1), kFewest, kMost));
  // A short clip is one batch, whose memory need be no larger: to clear it takes long.
  return static_cast<int>(std::min<std::int64_t>(usual, options.frames.count()));
}

int threads_beside(const TrackOptions& options, std::span<opencl::Engine* const> engines) {
  const auto allowed = static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  const bool gpu = options.with_field &&
                   std::any_of(engines.begin(), engines.end(), [](const opencl::Engine* engine) {
                     return engine->device().is_gpu;
                   });
  const auto cores = static_cast<int>(std::thread::hardware_concurrency());
  return gpu && cores > 0 ? std::min(allowed, cores / 2 + 1) : allowed;
}

}  // namespace impactdic::pipeline
