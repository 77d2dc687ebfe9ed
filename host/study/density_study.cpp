#include "host/study/density_study.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "host/dic/correlator.h"
#include "host/dic/frames/cubic_spline.h"
#include "host/dic/reference/published.h"
#include "sim/speckle/render.h"

namespace impactdic::study {
namespace {

using Motions = std::vector<WindowMotion>;

// Two frames of a ball that moved, and windows all over it.
struct Scenery {
  Frame first, second;
  std::vector<Window> windows;
};

Scenery make_scenery(const DensityStudyRequest& options) {
  constexpr double kMarginPx = 16;
  SynthScene scene;
  scene.width = scene.height = static_cast<int>(std::ceil(2 * (options.radius_px + kMarginPx)));
  scene.noise_sigma = options.noise;
  scene.noise_seed = options.seed;
  const sim::speckle::BallRenderer renderer(
      sim::speckle::paint_ball(options.pattern, options.seed, options.radius_px), scene);
  const double middle = (scene.width - 1) / 2.0;
  Scenery made;
  renderer.render(BallPose{middle, middle}, 0, made.first);
  renderer.render(BallPose{middle + options.dx_px, middle + options.dy_px}, 1, made.second);
  constexpr double kRimPx = 3;
  const std::vector<Window> all = dic::disc_grid(middle, middle, options.radius_px - kRimPx,
                                                 options.window_px, (options.window_px + 1) / 2);
  const auto wanted = std::min(all.size(), static_cast<std::size_t>(options.windows));
  for (std::size_t i = 0; i < wanted; ++i) {
    made.windows.push_back(all[i * all.size() / wanted]);
    made.windows.back().second = 1;
  }
  return made;
}

FieldOptions field_options(const DensityStudyRequest& options, FieldMethod method, int points) {
  FieldOptions field;
  field.method = method;
  field.window_px = options.window_px;
  field.interp_points = points;
  return field;
}

// Calls `measure` and returns the shortest of its times, s.
template <typename Measure>
double shortest_time(int repeats, const Measure& measure) {
  double best = 0;
  for (int i = 0; i < repeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    measure();
    const double taken =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (i == 0 || taken < best) best = taken;
  }
  return best;
}

DensityRow sum_up(const Motions& motions, const Motions& literal, const std::string& method,
                  int points, double seconds, const DensityStudyRequest& options) {
  DensityRow row;
  row.points = points;
  row.method = method;
  row.us_per_window = 1e6 * seconds / static_cast<double>(motions.size());
  double squares = 0, count = 0, same = 0;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const double du = motions[i].u - options.dx_px, dv = motions[i].v - options.dy_px;
    same += std::abs(motions[i].u - literal[i].u) < 1e-4 &&
            std::abs(motions[i].v - literal[i].v) < 1e-4;
    if (!std::isfinite(du + dv)) continue;
    row.bias_x_px += du;
    row.bias_y_px += dv;
    squares += du * du + dv * dv;
    ++count;
  }
  row.bias_x_px /= count;
  row.bias_y_px /= count;
  row.rms_px = std::sqrt(squares / (2 * count));
  row.same_lag_share = method == "icgn" ? kNotMeasured : same / static_cast<double>(motions.size());
  return row;
}

Image<double> cut(const Frame& frame, const Window& window, int side) {
  Image<double> out(side, side);
  const Image<float> picture = frame.to_float();
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) out(x, y) = picture(window.x0 + x, window.y0 + y);
  }
  return out;
}

Image<double> with_points(const Image<double>& window, int points) {
  const int side = window.width();
  const std::vector<double> matrix = dic::cubic_interpolation_matrix(side, points);
  const int fine = static_cast<int>(matrix.size()) / side;
  const auto weight = [&](int row, int k) {
    return matrix[static_cast<std::size_t>(row) * static_cast<std::size_t>(side) +
                  static_cast<std::size_t>(k)];
  };
  Image<double> across(fine, side, 0.0), out(fine, fine, 0.0);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < fine; ++x) {
      for (int k = 0; k < side; ++k) across(x, y) += weight(x, k) * window(k, y);
    }
  }
  for (int y = 0; y < fine; ++y) {
    for (int x = 0; x < fine; ++x) {
      for (int k = 0; k < side; ++k) out(x, y) += weight(y, k) * across(x, k);
    }
  }
  return out;
}

}  // namespace

DensityStudyResult run_density_study(opencl::Engine& engine, const DensityStudyRequest& options,
                                     const RunControl& control) {
  const Scenery scenery = make_scenery(options);
  const Image<float> first = scenery.first.to_float(), second = scenery.second.to_float();
  DensityStudyResult study;
  constexpr int kFigurePoints = 5;
  study.window = cut(scenery.first, scenery.windows[scenery.windows.size() / 2], options.window_px);
  study.interpolated = with_points(study.window, kFigurePoints);
  for (int points = 0; points <= options.most_points; ++points) {
    study.cancelled = control.is_cancelled();
    if (study.cancelled) break;
    const FieldOptions published = field_options(options, FieldMethod::kPublished, points);
    const dic::PublishedReference reference(published);
    Motions literal(scenery.windows.size());
    const double literal_time = shortest_time(options.repeats, [&] {
      for (std::size_t i = 0; i < literal.size(); ++i) {
        literal[i] = reference.measure(first.view(), second.view(), scenery.windows[i],
                                       scenery.first.full_scale());
      }
    });
    study.rows.push_back(sum_up(literal, literal, "literal", points, literal_time, options));
    for (const FieldMethod method : {FieldMethod::kPublished, FieldMethod::kIcgn}) {
      const auto correlator =
          dic::make_opencl_correlator(engine, field_options(options, method, points), 2);
      correlator->set_frame(0, scenery.first);
      correlator->set_frame(1, scenery.second);
      // The first call allocates, and prepares the frames.
      Motions motions = correlator->correlate(scenery.windows);
      const double time =
          shortest_time(options.repeats, [&] { motions = correlator->correlate(scenery.windows); });
      study.rows.push_back(sum_up(motions, literal, to_string(method), points, time, options));
    }
    if (control.progress) control.progress({"study", points + 1, options.most_points + 1});
  }
  return study;
}

}  // namespace impactdic::study
