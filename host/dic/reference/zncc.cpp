#include "host/dic/reference/zncc.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "host/dic/device/map_spline.h"

namespace impactdic::dic {
namespace {

using Pixels = std::vector<double>;

// Cubic convolution (Keys 1981, a = −1/2) with the edge pixels repeated outwards.
double cubic_pixel(ImageView<const float> image, double x, double y) {
  const auto weight = [](double d) {
    d = std::abs(d);
    if (d < 1) return (1.5 * d - 2.5) * d * d + 1;
    return d < 2 ? ((-0.5 * d + 2.5) * d - 4) * d + 2 : 0;
  };
  const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
  double sum = 0;
  for (int j = iy - 1; j <= iy + 2; ++j) {
    for (int i = ix - 1; i <= ix + 2; ++i) {
      sum += weight(x - i) * weight(y - j) *
             image(std::clamp(i, 0, image.width - 1), std::clamp(j, 0, image.height - 1));
    }
  }
  return sum;
}

// The window's pixels, turned about its centre by the guessed rotation; less their mean.
Pixels mean_free_template(ImageView<const float> image, const Window& window, int size) {
  Pixels pixels(static_cast<std::size_t>(size) * size);
  const double half = (size - 1) / 2.0, turn = window.guess_rot_rad;
  double mean = 0;
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      const double dx = i - half, dy = j - half;
      double& pixel = pixels[static_cast<std::size_t>(j) * size + i];
      // What is turned counter-clockwise on the screen (y down) onto (dx, dy).
      pixel = turn == 0
                  ? image(window.x0 + i, window.y0 + j)
                  : cubic_pixel(image, window.x0 + half + dx * std::cos(turn) - dy * std::sin(turn),
                                window.y0 + half + dx * std::sin(turn) + dy * std::cos(turn));
      mean += pixel;
    }
  }
  mean /= static_cast<double>(pixels.size());
  for (double& pixel : pixels) pixel -= mean;
  return pixels;
}

double template_energy(const Pixels& pixels) {
  double sum = 0;
  for (const double pixel : pixels) sum += pixel * pixel;
  return sum;
}

// ZNCC of the mean-free template with the window whose first pixel is (x0, y0); 0 where that one
// has less than `min_energy`.
double zncc_at(const Pixels& pixels, double energy, ImageView<const float> image, int x0, int y0,
               int size, double min_energy) {
  double sum = 0, squares = 0, product = 0;
  for (int j = 0; j < size; ++j) {
    const float* row = image.row(y0 + j) + x0;
    for (int i = 0; i < size; ++i) sum += row[i];
  }
  const double mean = sum / static_cast<double>(pixels.size());
  for (int j = 0; j < size; ++j) {
    const float* row = image.row(y0 + j) + x0;
    for (int i = 0; i < size; ++i) {
      const double pixel = row[i] - mean;
      squares += pixel * pixel;
      product += pixel * pixels[static_cast<std::size_t>(j) * size + i];
    }
  }
  return squares > min_energy && squares > 0 ? product / std::sqrt(squares * energy) : 0;
}

// The lags, −search … search about the guess, at which the displaced window is in the picture.
struct LagRange {
  int low, high;
};
LagRange lags_in_view(std::int64_t at_guess, int size, int extent, int search) {
  const auto low = std::max<std::int64_t>(-search, -at_guess);
  const auto high = std::min<std::int64_t>(search, extent - size - at_guess);
  if (low > high) return {0, -1};
  return {static_cast<int>(low), static_cast<int>(high)};
}

// The spline through nx × ny values, and its derivatives.
class Surface {
 public:
  Surface(const std::vector<double>& values, int nx, int ny)
      : nx_(nx), ny_(ny), coefficients_(values.size()) {
    const auto across = quintic_inverse(nx), down = quintic_inverse(ny);
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        double sum = 0;
        for (int y = 0; y < ny; ++y) {
          for (int x = 0; x < nx; ++x) {
            sum += down[static_cast<std::size_t>(j * ny + y)] *
                   across[static_cast<std::size_t>(i * nx + x)] *
                   values[static_cast<std::size_t>(y * nx + x)];
          }
        }
        coefficients_[static_cast<std::size_t>(j * nx + i)] = sum;
      }
    }
  }
  double operator()(double x, double y, int by_x, int by_y) const {
    const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
    double sum = 0;
    for (int j = iy - 2; j <= iy + 3; ++j) {
      for (int i = ix - 2; i <= ix + 3; ++i) {
        const int at = mirrored_index(j, ny_) * nx_ + mirrored_index(i, nx_);
        sum += coefficients_[static_cast<std::size_t>(at)] * b_spline(5, x - i, by_x) *
               b_spline(5, y - j, by_y);
      }
    }
    return sum;
  }

 private:
  int nx_, ny_;
  std::vector<double> coefficients_;
};

// Where a parabola through three samples about the highest has its peak, −1/2 … 1/2.
double parabola_peak(double before, double at, double after) {
  const double bend = before - 2 * at + after;
  return bend < 0 ? 0.5 * (before - after) / bend : 0;
}

// Newton's method from the highest sample (x, y) to the spline's highest point.
WindowMotion highest_point(const Surface& surface, int x, int y, double pixels, double at_sample,
                           double min_correlation) {
  const auto sample = [&](int i, int j) { return surface(x + i, y + j, 0, 0); };
  double tx = x + parabola_peak(sample(-1, 0), sample(0, 0), sample(1, 0));
  double ty = y + parabola_peak(sample(0, -1), sample(0, 0), sample(0, 1));
  bool converged = false;
  double xx = 0, xy = 0, yy = 0, determinant = 0;
  const auto is_hill = [&] {
    xx = surface(tx, ty, 2, 0);
    xy = surface(tx, ty, 1, 1);
    yy = surface(tx, ty, 0, 2);
    determinant = xx * yy - xy * xy;
    return determinant > 0 && xx < 0;
  };
  constexpr double kFarthest = 0.99;
  for (int step = 0; step < 20 && !converged && is_hill(); ++step) {
    const double gx = surface(tx, ty, 1, 0), gy = surface(tx, ty, 0, 1);
    const double to_x =
        std::clamp(tx + (xy * gy - yy * gx) / determinant, x - kFarthest, x + kFarthest);
    const double to_y =
        std::clamp(ty + (xy * gx - xx * gy) / determinant, y - kFarthest, y + kFarthest);
    converged = std::abs(to_x - tx) < 1e-5 && std::abs(to_y - ty) < 1e-5;
    tx = to_x;
    ty = to_y;
  }
  if (!converged || !is_hill() || std::abs(tx - x) >= kFarthest || std::abs(ty - y) >= kFarthest) {
    return without_motion(WindowStatus::kNotConverged, at_sample);
  }
  const double correlation = std::min(surface(tx, ty, 0, 0), 1.0);
  if (correlation < min_correlation) {
    return without_motion(WindowStatus::kLowCorrelation, correlation);
  }
  const double residual = 2 * (1 - correlation) / (pixels - 4);
  WindowMotion motion{};
  motion.u = static_cast<float>(tx - x);
  motion.v = static_cast<float>(ty - y);
  motion.u_sd = static_cast<float>(std::sqrt(residual * -yy / determinant));
  motion.v_sd = static_cast<float>(std::sqrt(residual * -xx / determinant));
  motion.correlation = static_cast<float>(correlation);
  motion.status = static_cast<idic_int>(WindowStatus::kOk);
  return motion;
}

}  // namespace

WindowMotion without_motion(WindowStatus status, double correlation) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  return {kNan, kNan, kNan, kNan, static_cast<float>(correlation), kNan,
          kNan, kNan, kNan, kNan, static_cast<idic_int>(status)};
}

double min_contrast(const FieldOptions& options, double full_scale) {
  // A flat window's mean, rounded to a float, leaves a contrast of its own.
  constexpr double kRounding = 1e-3;
  return std::max(options.min_texture, kRounding) * full_scale / 255;
}

double second_peak(const std::vector<double>& map, int width, int x0, int x1, int y0, int y1, int x,
                   int y) {
  const auto at = [&](int i, int j) { return map[static_cast<std::size_t>(j) * width + i]; };
  double highest = -2;
  for (int j = y0; j <= y1; ++j) {
    for (int i = x0; i <= x1; ++i) {
      if (std::abs(i - x) <= 2 && std::abs(j - y) <= 2) continue;
      bool is_maximum = true;
      for (int b = std::max(j - 1, y0); b <= std::min(j + 1, y1); ++b) {
        for (int a = std::max(i - 1, x0); a <= std::min(i + 1, x1); ++a) {
          is_maximum = is_maximum && at(a, b) <= at(i, j);
        }
      }
      if (is_maximum) highest = std::max(highest, at(i, j));
    }
  }
  return highest;
}

double peak_ratio(double highest, double second) {
  return highest / std::max(second, 1e-3 * highest);
}

WindowMotion zncc_reference(ImageView<const float> first, ImageView<const float> second,
                            const Window& window, const FieldOptions& options, double full_scale) {
  const int size = options.window_px, search = options.search_px, width = 2 * search + 1;
  const LagRange own_x = lags_in_view(window.x0, size, first.width, 0);
  const LagRange own_y = lags_in_view(window.y0, size, first.height, 0);
  const auto x_at_guess = static_cast<std::int64_t>(window.x0) + window.guess_u;
  const auto y_at_guess = static_cast<std::int64_t>(window.y0) + window.guess_v;
  const LagRange lag_x = lags_in_view(x_at_guess, size, second.width, search);
  const LagRange lag_y = lags_in_view(y_at_guess, size, second.height, search);
  if (own_x.low > own_x.high || own_y.low > own_y.high || lag_x.low > lag_x.high ||
      lag_y.low > lag_y.high) {
    return without_motion(WindowStatus::kOutOfView, std::numeric_limits<double>::quiet_NaN());
  }
  const Pixels pixels = mean_free_template(first, window, size);
  const double energy = template_energy(pixels), contrast = min_contrast(options, full_scale);
  const auto count = static_cast<double>(pixels.size());
  if (std::sqrt(energy / count) < contrast) {
    return without_motion(WindowStatus::kNoTexture, std::numeric_limits<double>::quiet_NaN());
  }

  std::vector<double> map(static_cast<std::size_t>(width) * width, -2);
  int best_x = lag_x.low, best_y = lag_y.low;
  const auto at = [&](int x, int y) -> double& {
    return map[static_cast<std::size_t>(y + search) * width + (x + search)];
  };
  for (int y = lag_y.low; y <= lag_y.high; ++y) {
    for (int x = lag_x.low; x <= lag_x.high; ++x) {
      at(x, y) =
          zncc_at(pixels, energy, second, static_cast<int>(x_at_guess) + x,
                  static_cast<int>(y_at_guess) + y, size, 0.01 * contrast * contrast * count);
      if (at(x, y) > at(best_x, best_y)) {
        best_x = x;
        best_y = y;
      }
    }
  }
  const double highest = at(best_x, best_y);
  if (best_x == lag_x.low || best_x == lag_x.high || best_y == lag_y.low || best_y == lag_y.high) {
    return without_motion(WindowStatus::kAtSearchEdge, highest);
  }
  constexpr int kReach = PEAK_PATCH_PX / 2;
  const int x0 = std::max(best_x - kReach, lag_x.low), x1 = std::min(best_x + kReach, lag_x.high);
  const int y0 = std::max(best_y - kReach, lag_y.low), y1 = std::min(best_y + kReach, lag_y.high);
  std::vector<double> patch;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) patch.push_back(at(x, y));
  }
  const Surface surface(patch, x1 - x0 + 1, y1 - y0 + 1);
  WindowMotion motion =
      highest_point(surface, best_x - x0, best_y - y0, count, highest, options.min_correlation);
  if (motion.status != static_cast<idic_int>(WindowStatus::kOk)) return motion;
  motion.u += static_cast<float>(window.guess_u + best_x);
  motion.v += static_cast<float>(window.guess_v + best_y);
  motion.peak_ratio = static_cast<float>(peak_ratio(
      highest, second_peak(map, width, lag_x.low + search, lag_x.high + search, lag_y.low + search,
                           lag_y.high + search, best_x + search, best_y + search)));
  return motion;
}

}  // namespace impactdic::dic
