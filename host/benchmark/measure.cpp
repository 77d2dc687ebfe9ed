#include "host/benchmark/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <random>

#include "host/base/statistics.h"
#include "host/opencl/arguments.h"
#include "host/opencl/buffer.h"
#include "sim/speckle/speckle_field.h"

namespace impactdic::benchmark {
namespace {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double best_time(const std::function<void()>& run) {
  run();
  double best = 1e30;
  for (int k = 0; k < 5; ++k) {
    const double start = now_s();
    run();
    best = std::min(best, now_s() - start);
  }
  return best;
}

}  // namespace

Roofline measure_roofline(opencl::Engine& engine) {
  Roofline roofline;
  const cl::CommandQueue& queue = engine.queue();
  const std::size_t bytes = std::size_t{engine.device().is_gpu ? 1024U : 64U} << 20;
  const opencl::Buffer<cl_float4> in(engine, bytes / 16), out(engine, bytes / 16);
  cl::Kernel copy = engine.kernel("roofline.cl", "copy");
  opencl::set_arguments(copy, in.get(), out.get());
  roofline.copy_bytes_per_s =
      2.0 * static_cast<double>(bytes) / best_time([&] {
        engine.launch(queue, copy, cl::NDRange(bytes / 16), cl::NDRange(64));
        queue.finish();
      });
  // As in roofline.cl.
  constexpr double kOperations = 2.0 * 4 * 8 * 256;
  const std::size_t items = engine.device().is_gpu ? std::size_t{1} << 22 : std::size_t{1} << 16;
  cl::Kernel adds = engine.kernel("roofline.cl", "multiply_adds");
  opencl::set_arguments(adds, out.get(), 0.999F);
  roofline.flops_per_s = kOperations * static_cast<double>(items) / best_time([&] {
                           engine.launch(queue, adds, cl::NDRange(items), cl::NDRange(64));
                           queue.finish();
                         });
  return roofline;
}

void measure_time(BenchRow& row, double seconds, const std::function<void()>& run) {
  run();
  std::vector<double> times;
  const double start = now_s();
  const std::clock_t cpu = std::clock();
  while (times.size() < 3 || now_s() - start < seconds) {
    const double begin = now_s();
    run();
    times.push_back(now_s() - begin);
  }
  row.cpu_s =
      static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC / static_cast<double>(times.size());
  row.runs = static_cast<int>(times.size());
  row.median_s = upper_median(times);
  row.least_s = *std::min_element(times.begin(), times.end());
}

ShiftedPictures make_shifted_pictures(int count, int width, int height, double largest_px) {
  ShiftedPictures pictures;
  const double margin = 16;
  const double extent = std::max(width, height) + 2 * margin;
  // About one blot to 17 px², of 1.5 px: the density of fine paint.
  const sim::speckle::SpeckleField surface(static_cast<int>(extent * extent / 17), extent, 1.5, 7);
  std::mt19937 random(5);
  const auto place = [&] {
    return largest_px * (static_cast<double>(random() >> 8) * 0x1p-23 - 1.0) * 0.5;
  };
  for (int k = 0; k < count; ++k) {
    pictures.x.push_back(place());
    pictures.y.push_back(place());
    pictures.frames.push_back(surface.render(width, height, pictures.x.back() - margin,
                                             pictures.y.back() - margin, 0, 0, 0, 8, 1,
                                             static_cast<unsigned>(k + 1)));
  }
  return pictures;
}

bool is_wanted(const BenchOptions& options, const std::string& work) {
  return work.find(options.only) != std::string::npos;
}

void put_errors(BenchRow& row, const ShiftedPictures& pictures, std::span<const Window> windows,
                std::span<const WindowMotion> motions) {
  const std::size_t count = pictures.frames.size();
  double along = 0, length = 0, squares = 0;
  std::size_t ok = 0;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (motions[i].status != static_cast<idic_int>(WindowStatus::kOk)) continue;
    const auto first = static_cast<std::size_t>(windows[i].first) % count;
    const auto second = static_cast<std::size_t>(windows[i].second) % count;
    const double u = pictures.x[second] - pictures.x[first];
    const double v = pictures.y[second] - pictures.y[first];
    const double du = motions[i].u - u, dv = motions[i].v - v;
    along += du * u + dv * v;
    length += std::hypot(u, v);
    squares += du * du + dv * dv;
    ++ok;
  }
  const auto all = static_cast<double>(windows.size());
  row.lost = 1 - static_cast<double>(ok) / all;
  row.bias_px = length > 0 ? along / length : 0;
  row.rms_px = ok > 0 ? std::sqrt(squares / (2.0 * static_cast<double>(ok))) : 0;
}

}  // namespace impactdic::benchmark
