#include "host/benchmark/tune.h"

#include <impactdic/error.h>

#include <cmath>

#include "host/benchmark/measure.h"
#include "host/dic/reference/equal.h"
#include "host/dic/reference/zncc.h"

namespace impactdic::benchmark {
namespace {

// Windows that are compared with the reference, which is slow.
constexpr std::size_t kCompared = 48;

struct Trial {
  opencl::Engine& engine;
  dic::DeviceFrames frames;
  std::vector<Window> list;
  std::vector<WindowMotion> expected;  // of every stride-th window
  std::size_t stride = 1;
  opencl::Buffer<Window> windows;
  opencl::Buffer<WindowMotion> motions;

  using Reference = std::function<WindowMotion(ImageView<const float>, ImageView<const float>,
                                               const Window&, double full_scale)>;

  // The pairs of a clip with moderate shifts, the grid on each of them.
  Trial(opencl::Engine& on, const std::vector<Window>& grid, const Reference& reference)
      : engine(on), frames(on, pairs_of(on) + 1) {
    constexpr int kPictures = 4;
    const ShiftedPictures pictures = make_shifted_pictures(kPictures, kSide, kSide, 6);
    std::vector<Image<float>> floats;
    for (const Frame& frame : pictures.frames) floats.push_back(frame.to_float());
    for (int slot = 0; slot < frames.slots(); ++slot) {
      frames.set(slot, pictures.frames[static_cast<std::size_t>(slot % kPictures)]);
    }
    for (int pair = 0; pair + 1 < frames.slots(); ++pair) {
      for (Window window : grid) {
        window.first = pair;
        window.second = pair + 1;
        list.push_back(window);
      }
    }
    stride = std::max<std::size_t>(1, list.size() / kCompared);
    for (std::size_t i = 0; i < list.size(); i += stride) {
      const auto view = [&](int slot) {
        return floats[static_cast<std::size_t>(slot % kPictures)].view();
      };
      expected.push_back(
          reference(view(list[i].first), view(list[i].second), list[i], frames.full_scale()));
    }
    windows = opencl::make_buffer<Window>(engine, list);
    motions = opencl::Buffer<WindowMotion>(engine, list.size());
  }

  static int pairs_of(const opencl::Engine& engine) { return engine.device().is_gpu ? 64 : 1; }

  // Fills in difference_px; says what is wrong with the motions.
  std::string judge(dic::TunedKernel& kernel, double largest_px) {
    const std::vector<WindowMotion> measured = motions.to_vector(engine);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const WindowMotion &a = measured[i * stride], &b = expected[i];
      if (a.status != b.status) return "other status than the reference";
      if (b.status != static_cast<idic_int>(WindowStatus::kOk)) continue;
      const double difference = std::max(std::abs(a.u - b.u), std::abs(a.v - b.v));
      if (!(difference <= largest_px)) kernel.difference_px = difference;
      kernel.difference_px = std::max(kernel.difference_px, difference);
    }
    return kernel.difference_px <= largest_px ? "" : "differs from the reference";
  }
};

// `make(variant)` returns what measures the trial's windows.
template <typename Variant, typename Make>
dic::TunedKernel tune(Trial& trial, const std::string& work, const std::vector<Variant>& variants,
                      const TuneOptions& options, const TuneSink& sink, const Make& make) {
  dic::TunedKernel best;
  for (const Variant& variant : variants) {
    TunedVariant tried;
    tried.kernel.work = work;
    tried.kernel.variant = variant.name();
    try {
      auto method = make(variant);
      BenchRow row;
      row.count = static_cast<double>(trial.list.size());
      measure_time(row, options.seconds, [&] {
        method.run(trial.frames, trial.windows, trial.list.size(), trial.motions);
        trial.engine.queue().finish();
      });
      tried.kernel.per_second = row.per_second();
      tried.rejected = trial.judge(tried.kernel, options.largest_difference_px);
    } catch (const Error& error) {  // a driver that does not take it
      tried.rejected = error.line();
    }
    sink(tried);
    if (tried.rejected.empty() && tried.kernel.per_second > best.per_second) best = tried.kernel;
  }
  if (best.variant.empty()) throw Error("no variant of the kernel is right", work);
  return best;
}

}  // namespace

dic::TunedKernel tune_zncc(opencl::Engine& engine, const FieldOptions& field,
                           const TuneOptions& options, const TuneSink& sink) {
  const int margin = field.search_px, side = kSide - 2 * margin;
  Trial trial(engine, dic::rectangle_grid(margin, margin, side, side, field.window_px, 16),
              [&](auto first, auto second, const Window& window, double full_scale) {
                return dic::zncc_reference(first, second, window, field, full_scale);
              });
  return tune(
      trial, dic::zncc_work(field), dic::zncc_variants(engine.device(), field), options, sink,
      [&](const dic::ZnccVariant& variant) { return dic::ZnccOpencl(engine, field, variant); });
}

dic::TunedKernel tune_equal(opencl::Engine& engine, const FieldOptions& field,
                            const TuneOptions& options, const TuneSink& sink) {
  const auto grid = dic::rectangle_grid(0, 0, kSide, kSide, field.window_px, field.window_px / 2);
  Trial trial(engine, grid, [&](auto first, auto second, const Window& window, double full_scale) {
    return dic::equal_reference(first, second, window, field, full_scale);
  });
  return tune(trial, dic::equal_work(field.window_px),
              dic::equal_variants(engine.device(), field.window_px), options, sink,
              [&](const dic::EqualVariant& variant) {
                struct OfClip {
                  dic::EqualOpencl equal;
                  std::size_t period;
                  void run(const dic::DeviceFrames& frames, const opencl::Buffer<Window>& windows,
                           std::size_t count, opencl::Buffer<WindowMotion>& motions) {
                    equal.run(frames, windows, count, motions, period);
                  }
                };
                return OfClip{dic::EqualOpencl(engine, field, variant), grid.size()};
              });
}

std::vector<dic::TunedKernel> tune_and_keep(opencl::Engine& engine, int window_px, int search_px,
                                            const TuneOptions& options, const TuneSink& sink) {
  std::vector<FieldOptions> sizes;
  const auto add = [&sizes](int window, int search) {
    FieldOptions& field = sizes.emplace_back();
    field.method = FieldMethod::kZncc;
    field.window_px = window;
    field.search_px = search;
    field.validate();
  };
  if (window_px > 0) {
    add(window_px, search_px);
  } else {
    add(15, 8);
    add(31, 8);
    add(31, 16);
  }
  dic::store_tuning(engine, {});
  std::vector<dic::TunedKernel> best;
  for (const FieldOptions& field : sizes) {
    best.push_back(tune_zncc(engine, field, options, sink));
  }
  if (window_px == 0) {
    FieldOptions field;
    field.window_px = 32;
    field.min_correlation = 0.3;
    best.push_back(tune_equal(engine, field, options, sink));
  }
  dic::store_tuning(engine, best);
  return best;
}

}  // namespace impactdic::benchmark
