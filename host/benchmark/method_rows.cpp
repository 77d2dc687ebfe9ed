// Whole methods from frames in host memory to displacements in host memory.
#include <cstring>
#include <future>
#include <memory>

#include "host/benchmark/equal_stream.h"
#include "host/benchmark/measure.h"
#include "host/dic/correlator.h"

namespace impactdic::benchmark {
namespace {

// Both frames of a pair in, all windows out.
void bench_pair(opencl::Engine& engine, const BenchOptions& options, const RowSink& sink,
                const FieldOptions& field, const std::string& work, const std::string& variant,
                std::vector<Window> windows) {
  if (!is_wanted(options, work)) return;
  const ShiftedPictures pictures = make_shifted_pictures(2, kSide, kSide, 2);
  for (Window& window : windows) window.second = 1;
  const auto correlator = dic::make_opencl_correlator(engine, field, 2);
  std::vector<WindowMotion> motions;
  BenchRow row;
  row.work = work;
  row.variant = variant;
  row.unit = "points";
  row.count = static_cast<double>(windows.size());
  measure_time(row, options.seconds, [&] {
    for (int k = 0; k < 2; ++k) {
      correlator->set_frame(k, pictures.frames[static_cast<std::size_t>(k)]);
    }
    motions = correlator->correlate(windows);
  });
  put_errors(row, pictures, windows, motions);
  sink(row);
}

constexpr int kStreamPictures = 8;

// A device's stream with its pictures in place: `pairs` pairs a batch.
struct DeviceStream {
  benchmark::EqualStream stream;

  DeviceStream(const opencl::Engine& engine, const FieldOptions& field,
               const ShiftedPictures& pictures, const std::vector<Window>& windows, int pairs,
               int workers)
      : stream(engine, field,
               {kSide, kSide, PixelType::kU8, 255, pairs + 1, windows.size() / pairs}, windows,
               workers) {
    for (int worker = 0; worker < workers; ++worker) {
      const auto bytes = stream.pictures(worker);
      for (std::size_t k = 0; k <= static_cast<std::size_t>(pairs); ++k) {
        const Frame& frame = pictures.frames[k % kStreamPictures];
        std::memcpy(bytes.data() + k * frame.byte_count(), frame.bytes(), frame.byte_count());
      }
    }
  }

  void run(int batches) {
    const int workers = stream.workers();
    for (int k = 0; k < batches + workers; ++k) {
      if (k >= workers) stream.wait(k % workers);
      if (k < batches) stream.start(k % workers);
    }
  }
};

// Pictures in page-locked host memory in, displacements out, on every device at once.
void bench_stream(std::span<opencl::Engine* const> engines, const BenchOptions& options,
                  const RowSink& sink) {
  const std::string work = "stream equal 32x32";
  if (!is_wanted(options, work)) return;
  const bool is_gpu = engines.front()->device().is_gpu;
  const int pairs = options.batch > 0 ? options.batch : is_gpu ? 128 : 2;
  const int workers = is_gpu ? 3 : 1, batches = is_gpu ? 64 : 2;
  const ShiftedPictures pictures = make_shifted_pictures(kStreamPictures, kSide, kSide, 6);
  FieldOptions field;
  field.window_px = 32;
  field.min_correlation = 0.3;
  std::vector<Window> windows;
  for (int pair = 0; pair < pairs; ++pair) {
    for (Window window : dic::rectangle_grid(0, 0, kSide, kSide, 32, 16)) {
      window.first = pair;
      window.second = pair + 1;
      windows.push_back(window);
    }
  }
  std::vector<std::unique_ptr<DeviceStream>> all;
  for (const opencl::Engine* engine : engines) {
    all.push_back(
        std::make_unique<DeviceStream>(*engine, field, pictures, windows, pairs, workers));
    const std::size_t devices = all.size();
    if (devices > 1 && devices < engines.size()) continue;
    BenchRow row;
    row.work = work;
    row.variant = "host to host, " + std::to_string(workers) + " in flight";
    if (devices > 1) row.variant += ", " + std::to_string(devices) + " devices";
    row.unit = "frames";
    row.count = static_cast<double>(pairs) * batches * static_cast<double>(devices);
    measure_time(row, options.seconds, [&] {
      std::vector<std::future<void>> runs;
      for (const auto& device : all) {
        runs.push_back(std::async(std::launch::async, [&] { device->run(batches); }));
      }
      for (auto& run : runs) run.get();
    });
    row.bytes = kSide * kSide + 961.0 * sizeof(WindowMotion);
    row.flops = 961 * dic::equal_flops(32);
    put_errors(row, pictures, windows, all.back()->stream.wait(0));
    sink(row);
  }
}

}  // namespace

void bench_methods(std::span<opencl::Engine* const> engines, const BenchOptions& options,
                   const RowSink& sink) {
  opencl::Engine& engine = *engines.front();
  FieldOptions field;
  field.window_px = 31;
  bench_pair(engine, options, sink, field, "seed + icgn 31x31", "frames in, points out",
             dic::rectangle_grid(20, 20, 31 + 54 * 8, 31 + 54 * 8, 31, 8));
  field.window_px = 15;
  const auto grid = dic::rectangle_grid(20, 20, 460, 460, 15, 16);
  for (const int points : {0, 1, 3, 5, 7, 9}) {
    field.interp_points = points;
    const std::string density = "N = " + std::to_string(points);
    field.method = FieldMethod::kPublished;
    bench_pair(engine, options, sink, field, "published 15x15", density, grid);
    field.method = FieldMethod::kIcgn;
    bench_pair(engine, options, sink, field, "default 15x15", density, grid);
  }
  bench_stream(engines, options, sink);
}

}  // namespace impactdic::benchmark
