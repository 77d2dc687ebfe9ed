// Whole methods from frames in host memory to displacements in host memory.
#include <atomic>
#include <thread>

#include "bench/measure.h"
#include "host/dic/correlator.h"
#include "host/dic/tuning.h"

namespace impactdic {
namespace {

constexpr int kSide = 512;

bool is_wanted(const BenchOptions& options, const std::string& work) {
  return work.find(options.only) != std::string::npos;
}

// Both frames of a pair in, all windows out.
void bench_pair(Engine& engine, const BenchOptions& options, const RowSink& sink,
                const FieldOptions& field, const std::string& work, const std::string& variant,
                std::vector<Window> windows) {
  if (!is_wanted(options, work)) return;
  const ShiftedPictures pictures = make_shifted_pictures(2, kSide, kSide, 2);
  for (Window& window : windows) window.second = 1;
  const auto correlator = make_opencl_correlator(engine, field, 2);
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

// Frames in, displacements out, several workers whose copies and kernels overlap.
void bench_stream(Engine& engine, const BenchOptions& options, const RowSink& sink) {
  const std::string work = "stream equal 32x32";
  if (!is_wanted(options, work)) return;
  constexpr int kPictures = 8;
  const int batch = engine.device().is_gpu ? 128 : 2, workers = engine.device().is_gpu ? 4 : 1;
  const int batches = engine.device().is_gpu ? 64 : 2;
  const ShiftedPictures pictures = make_shifted_pictures(kPictures, kSide, kSide, 6);
  std::vector<const Frame*> given;
  for (int k = 0; k <= batch; ++k) given.push_back(&pictures.frames[k % kPictures]);
  FieldOptions field;
  field.window_px = 32;
  field.min_correlation = 0.3;
  std::vector<Window> windows;
  for (int pair = 0; pair < batch; ++pair) {
    for (Window window : rectangle_grid(0, 0, kSide, kSide, 32, 16)) {
      window.first = pair;
      window.second = pair + 1;
      windows.push_back(window);
    }
  }
  struct Worker {
    std::unique_ptr<Engine> engine;
    DeviceFrames frames;
    EqualOpencl equal;
    Buffer<Window> windows;
    Buffer<WindowMotion> motions;
    std::vector<WindowMotion> result;
    Worker(std::unique_ptr<Engine> own, const FieldOptions& field, int slots,
           const std::vector<Window>& list)
        : engine(std::move(own)),
          frames(*engine, slots),
          equal(*engine, field, choose_equal_variant(*engine, field.window_px)),
          windows(make_buffer<Window>(*engine, list)),
          motions(*engine, list.size()),
          result(list.size()) {}
  };
  std::vector<std::unique_ptr<Worker>> all;
  for (int k = 0; k < workers; ++k) {
    all.push_back(std::make_unique<Worker>(engine.beside(), field, batch + 1, windows));
  }
  BenchRow row;
  row.work = work;
  row.variant = "host to host, " + std::to_string(workers) + " in flight";
  row.unit = "frames";
  row.count = static_cast<double>(batch) * batches;
  measure_time(row, options.seconds, [&] {
    std::atomic<int> next{0};
    std::vector<std::thread> threads;
    for (const auto& worker : all) {
      threads.emplace_back([&, own = worker.get()] {
        while (next++ < batches) {
          own->frames.set(0, given);
          own->equal.run(own->frames, own->windows, windows.size(), own->motions);
          own->motions.read(*own->engine, own->result);
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  });
  row.bytes = kSide * kSide + 961.0 * sizeof(WindowMotion);
  row.flops = 961 * equal_flops(32);
  put_errors(row, pictures, windows, all.front()->result);
  sink(row);
}

}  // namespace

void bench_methods(Engine& engine, const BenchOptions& options, const RowSink& sink) {
  FieldOptions field;
  field.window_px = 31;
  bench_pair(engine, options, sink, field, "seed + icgn 31x31", "frames in, points out",
             rectangle_grid(20, 20, 31 + 54 * 8, 31 + 54 * 8, 31, 8));
  field.window_px = 15;
  const auto grid = rectangle_grid(20, 20, 460, 460, 15, 16);
  for (const int points : {0, 1, 3, 5, 7, 9}) {
    field.interp_points = points;
    const std::string density = "N = " + std::to_string(points);
    field.method = FieldMethod::published;
    bench_pair(engine, options, sink, field, "published 15x15", density, grid);
    field.method = FieldMethod::icgn;
    bench_pair(engine, options, sink, field, "default 15x15", density, grid);
  }
  bench_stream(engine, options, sink);
}

}  // namespace impactdic
