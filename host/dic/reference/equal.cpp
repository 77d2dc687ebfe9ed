#include "host/dic/reference/equal.h"

#include <cmath>
#include <vector>

#include "host/dic/reference/zncc.h"

namespace impactdic::dic {
namespace {

using Pixels = std::vector<double>;

Pixels mean_free_window(ImageView<const float> image, int x0, int y0, int side) {
  Pixels pixels;
  double mean = 0;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      pixels.push_back(image(x0 + x, y0 + y));
      mean += pixels.back();
    }
  }
  for (double& pixel : pixels) pixel -= mean / static_cast<double>(pixels.size());
  return pixels;
}

double sum_of_squares(const Pixels& pixels) {
  double sum = 0;
  for (const double pixel : pixels) sum += pixel * pixel;
  return sum;
}

double correlation_at(const Pixels& f, const Pixels& g, int side, int lag_x, int lag_y) {
  double sum = 0;
  for (int y = 0; y < side; ++y) {
    const double* row = g.data() + (y + lag_y + side) % side * side;
    for (int x = 0; x < side; ++x)
      sum += f[static_cast<std::size_t>(y) * side + x] * row[(x + lag_x + side) % side];
  }
  return sum;
}

bool holds(ImageView<const float> image, int x0, int y0, int side) {
  return x0 >= 0 && y0 >= 0 && x0 <= image.width - side && y0 <= image.height - side;
}

}  // namespace

WindowMotion equal_reference(ImageView<const float> first, ImageView<const float> second,
                             const Window& window, const FieldOptions& options, double full_scale) {
  const int side = options.window_px;
  const int x1 = window.x0 + window.guess_u, y1 = window.y0 + window.guess_v;
  if (!holds(first, window.x0, window.y0, side) || !holds(second, x1, y1, side)) {
    return without_motion(WindowStatus::kOutOfView, std::nan(""));
  }
  const Pixels f = mean_free_window(first, window.x0, window.y0, side);
  const Pixels g = mean_free_window(second, x1, y1, side);
  const double contrast = min_contrast(options, full_scale);
  if (std::min(sum_of_squares(f), sum_of_squares(g)) < contrast * contrast * side * side) {
    return without_motion(WindowStatus::kNoTexture, std::nan(""));
  }
  double highest = -1e300;
  int lag_x = 0, lag_y = 0;
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      const double value = correlation_at(f, g, side, x, y);
      if (value <= highest) continue;
      highest = value;
      lag_x = x < side / 2 ? x : x - side;
      lag_y = y < side / 2 ? y : y - side;
    }
  }
  const auto over_overlap = [&](int x, int y) {
    const auto lag = [side](int at) { return at >= side / 2 ? side - at : std::abs(at); };
    return correlation_at(f, g, side, x, y) * side * side / ((side - lag(x)) * (side - lag(y)));
  };
  const double centre = over_overlap(lag_x, lag_y);
  const double correlation =
      std::min(centre / std::sqrt(sum_of_squares(f) * sum_of_squares(g)), 1.0);
  if (lag_x == -side / 2 || lag_y == -side / 2) {
    return without_motion(WindowStatus::kAtSearchEdge, correlation);
  }
  if (correlation < options.min_correlation) {
    return without_motion(WindowStatus::kLowCorrelation, correlation);
  }
  double shift[2], bend[2];
  for (int axis = 0; axis < 2; ++axis) {
    const int dx = axis == 0, dy = axis == 1;
    const double before = over_overlap(lag_x - dx, lag_y - dy) / centre;
    const double after = over_overlap(lag_x + dx, lag_y + dy) / centre;
    bend[axis] = -(std::log(before) + std::log(after));
    shift[axis] = 0.5 * (std::log(after) - std::log(before)) / bend[axis];
    if (!(before > 0 && after > 0 && bend[axis] > 0)) {
      return without_motion(WindowStatus::kNotConverged, correlation);
    }
  }
  const double residual = 2 * (1 - correlation) / (side * side - 4.0);
  WindowMotion motion = without_motion(WindowStatus::kOk, correlation);
  motion.u = static_cast<float>(window.guess_u + lag_x + shift[0]);
  motion.v = static_cast<float>(window.guess_v + lag_y + shift[1]);
  motion.u_sd = static_cast<float>(std::sqrt(residual / (correlation * bend[0])));
  motion.v_sd = static_cast<float>(std::sqrt(residual / (correlation * bend[1])));
  motion.ux = motion.uy = motion.vx = motion.vy = 0;
  return motion;
}

}  // namespace impactdic::dic
