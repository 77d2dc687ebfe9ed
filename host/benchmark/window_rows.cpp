// Correlation of interrogation windows, frames already on the device.
#include <cmath>

#include "host/benchmark/measure.h"
#include "host/dic/device/equal.h"
#include "host/dic/device/icgn.h"
#include "host/dic/device/tuning.h"
#include "host/dic/device/zncc.h"
#include "host/dic/frames/spline_frames.h"

namespace impactdic::benchmark {
namespace {

constexpr int kPictures = 8;

const ShiftedPictures& pictures() {
  static const ShiftedPictures made = make_shifted_pictures(kPictures, kSide, kSide, 6);
  return made;
}

int pairs_of(const opencl::Engine& engine, const BenchOptions& options) {
  return options.batch > 0 ? options.batch : engine.device().is_gpu ? 256 : 1;
}

// A grid of windows on each of `pairs` pairs of neighbouring slots.
std::vector<Window> on_every_pair(const std::vector<Window>& grid, int pairs) {
  std::vector<Window> windows;
  for (int pair = 0; pair < pairs; ++pair) {
    for (Window window : grid) {
      window.first = pair;
      window.second = pair + 1;
      windows.push_back(window);
    }
  }
  return windows;
}

struct Setting {
  opencl::Engine& engine;
  dic::DeviceFrames frames;
  std::vector<Window> list;
  opencl::Buffer<Window> windows;
  opencl::Buffer<WindowMotion> motions;

  Setting(opencl::Engine& on, const std::vector<Window>& grid, int pairs)
      : engine(on), frames(on, pairs + 1), list(on_every_pair(grid, pairs)) {
    for (int slot = 0; slot <= pairs; ++slot) {
      frames.set(slot, pictures().frames[static_cast<std::size_t>(slot % kPictures)]);
    }
    windows = opencl::make_buffer<Window>(engine, list);
    motions = opencl::Buffer<WindowMotion>(engine, list.size());
  }
  std::size_t count() const { return list.size(); }
  void finish(BenchRow& row) {
    put_errors(row, pictures(), list, motions.to_vector(engine));
    row.count = static_cast<double>(count());
  }
};

}  // namespace

void bench_equal_windows(opencl::Engine& engine, const BenchOptions& options, const RowSink& sink) {
  FieldOptions field;
  field.window_px = 32;
  field.min_correlation = 0.3;
  // 961 windows at half their width: the 31 × 31 that 512 × 512 hold.
  const auto grid = dic::rectangle_grid(0, 0, kSide, kSide, 32, 16);
  // Each pair by itself, and the pictures of a clip, each of which belongs to two pairs.
  for (const bool of_clip : {false, true}) {
    const std::string work = of_clip ? "equal 32x32 of a clip" : "equal 32x32";
    if (!is_wanted(options, work)) continue;
    Setting setting(engine, grid, pairs_of(engine, options));
    auto variants = dic::equal_variants(engine.device(), field.window_px);
    if (!options.every_variant)
      variants = {dic::choose_equal_variant(engine, field.window_px, of_clip)};
    for (const dic::EqualVariant& variant : variants) {
      BenchRow row;
      row.work = work;
      row.variant = variant.name();
      dic::EqualOpencl equal(engine, field, variant);
      measure_time(row, options.seconds, [&] {
        equal.run(setting.frames, setting.windows, setting.count(), setting.motions,
                  of_clip ? grid.size() : 0);
        engine.queue().finish();
      });
      // Every pixel of the two frames once, shared by the windows of a pair; windows and results.
      row.bytes = 2.0 * kSide * kSide / 961 + sizeof(Window) + sizeof(WindowMotion);
      row.flops = dic::equal_flops(field.window_px);
      setting.finish(row);
      sink(row);
    }
  }
}

void bench_zncc(opencl::Engine& engine, const BenchOptions& options, const RowSink& sink) {
  struct Case {
    const char* work;
    int window_px, search_px, spacing_px;
  };
  for (const Case& c : {Case{"zncc 15 in 32", 15, 8, 16}, Case{"zncc 31 in 64", 31, 16, 16}}) {
    if (!is_wanted(options, c.work)) continue;
    FieldOptions field;
    field.method = FieldMethod::kZncc;
    field.window_px = c.window_px;
    field.search_px = c.search_px;
    const int margin = c.search_px;
    Setting setting(engine,
                    dic::rectangle_grid(margin, margin, kSide - 2 * margin, kSide - 2 * margin,
                                        c.window_px, c.spacing_px),
                    pairs_of(engine, options));
    auto variants = dic::zncc_variants(engine.device(), field);
    if (!options.every_variant) variants = {dic::choose_zncc_variant(engine, field)};
    for (const dic::ZnccVariant& variant : variants) {
      BenchRow row;
      row.work = c.work;
      row.variant = variant.name();
      dic::ZnccOpencl zncc(engine, field, variant);
      measure_time(row, options.seconds, [&] {
        zncc.run(setting.frames, setting.windows, setting.count(), setting.motions);
        engine.queue().finish();
      });
      setting.finish(row);
      row.flops = dic::zncc_flops(variant);
      row.bytes = 2.0 * kSide * kSide / (row.count / pairs_of(engine, options)) + sizeof(Window) +
                  sizeof(WindowMotion);
      sink(row);
    }
  }
}

void bench_icgn(opencl::Engine& engine, const BenchOptions& options, const RowSink& sink) {
  for (const int degree : {3, 5, 7}) {
    const std::string work = "icgn 31x31 degree " + std::to_string(degree);
    if (!is_wanted(options, work)) continue;
    FieldOptions field;
    field.window_px = 31;
    field.spline_degree = degree;
    const int pairs = options.batch > 0 ? options.batch : engine.device().is_gpu ? 32 : 1;
    Setting setting(engine, dic::rectangle_grid(20, 20, 31 + 54 * 8, 31 + 54 * 8, 31, 8), pairs);
    std::vector<WindowMotion> seeds(setting.count(), WindowMotion{});
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      const auto first = static_cast<std::size_t>(setting.list[i].first % kPictures);
      const auto second = static_cast<std::size_t>(setting.list[i].second % kPictures);
      seeds[i].u = static_cast<float>(std::round(pictures().x[second] - pictures().x[first]));
      seeds[i].v = static_cast<float>(std::round(pictures().y[second] - pictures().y[first]));
    }
    const auto device_seeds = opencl::make_buffer<WindowMotion>(engine, seeds);
    dic::IcgnRefiner refiner(engine, field, pairs + 1);
    dic::SplineFrames splines(engine, degree, 0.0, pairs + 1);
    for (const bool with_splines : {false, true}) {
      BenchRow row;
      row.work = work;
      row.variant = with_splines ? "splines included" : "splines there";
      row.unit = "points";
      measure_time(row, options.seconds, [&] {
        if (with_splines) {
          splines.forget();
          splines.prepare(setting.frames);
        }
        engine.queue().enqueueCopyBuffer(device_seeds.get(), setting.motions.get(), 0, 0,
                                         seeds.size() * sizeof(WindowMotion));
        refiner.refine(setting.frames, setting.windows, setting.count(), setting.motions);
        engine.queue().finish();
      });
      setting.finish(row);
      // Three steps are typical; the normal matrix counts as one more.
      row.flops = 31 * 31 * (3 * (2 * (degree + 1.0) * (degree + 1.0) + 60) + 100);
      row.bytes =
          (4.0 + 3 * 4.0) * kSide * kSide / 3025 + sizeof(Window) + 2 * sizeof(WindowMotion);
      sink(row);
    }
  }
}

}  // namespace impactdic::benchmark
