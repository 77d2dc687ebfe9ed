#include "host/dic/reference/published.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <unsupported/Eigen/FFT>

#include "host/dic/frames/cubic_spline.h"
#include "host/dic/reference/zncc.h"

namespace impactdic::dic {
namespace {

using Complex = std::complex<double>;

// A square picture, row-major.
struct Square {
  int side;
  std::vector<double> values;
  explicit Square(int n) : side(n), values(static_cast<std::size_t>(n) * n) {}
  double& operator()(int x, int y) { return values[static_cast<std::size_t>(y) * side + x]; }
  double operator()(int x, int y) const { return values[static_cast<std::size_t>(y) * side + x]; }
};

Square mean_free(ImageView<const float> image, int x0, int y0, int side) {
  Square window(side);
  double mean = 0;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) mean += window(x, y) = image(x0 + x, y0 + y);
  }
  mean /= static_cast<double>(window.values.size());
  for (double& value : window.values) value -= mean;
  return window;
}

double energy_of(const Square& square) {
  double sum = 0;
  for (const double value : square.values) sum += value * value;
  return sum;
}

// The bicubic spline through the window, line by line along x and then along y.
Square interpolated(const Square& window, const std::vector<double>& matrix) {
  const int n = window.side, fine = static_cast<int>(matrix.size()) / n;
  const auto weight = [&](int row, int k) { return matrix[static_cast<std::size_t>(row) * n + k]; };
  std::vector<double> across(static_cast<std::size_t>(n) * fine);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < fine; ++x) {
      double sum = 0;
      for (int k = 0; k < n; ++k) sum += weight(x, k) * window(k, y);
      across[static_cast<std::size_t>(y) * fine + x] = sum;
    }
  }
  Square out(fine);
  for (int y = 0; y < fine; ++y) {
    for (int k = 0; k < n; ++k) {
      const double w = weight(y, k);
      for (int x = 0; x < fine; ++x)
        out(x, y) += w * across[static_cast<std::size_t>(k) * fine + x];
    }
  }
  return out;
}

// Two-dimensional transform in place of a square of `side`.
void transform(std::vector<Complex>& data, int side, bool forward) {
  Eigen::FFT<double> fft;
  std::vector<Complex> line(static_cast<std::size_t>(side)), out;
  for (const bool along_rows : {true, false}) {
    const int step = along_rows ? 1 : side, next = along_rows ? side : 1;
    for (int i = 0; i < side; ++i) {
      Complex* start = data.data() + static_cast<std::ptrdiff_t>(i) * next;
      for (int k = 0; k < side; ++k) line[static_cast<std::size_t>(k)] = start[k * step];
      if (forward) {
        fft.fwd(out, line);
      } else {
        fft.inv(out, line);
      }
      for (int k = 0; k < side; ++k) start[k * step] = out[static_cast<std::size_t>(k)];
    }
  }
}

// The least length >= `count` without prime factors above 5, which transforms take quickly.
int smooth_length(int count) {
  for (int length = count;; ++length) {
    int rest = length;
    for (const int prime : {2, 3, 5}) {
      while (rest % prime == 0) rest /= prime;
    }
    if (rest == 1) return length;
  }
}

// Σ f(i) g(i + l) for all lags, l = 0 at (side − 1, side − 1), by FFT of zero-padded pictures.
Square cross_correlation(const Square& f, const Square& g) {
  const int padded = smooth_length(2 * f.side - 1);
  const auto spectrum = [&](const Square& square) {
    std::vector<Complex> data(static_cast<std::size_t>(padded) * padded);
    for (int y = 0; y < square.side; ++y) {
      for (int x = 0; x < square.side; ++x) {
        data[static_cast<std::size_t>(y) * padded + x] = square(x, y);
      }
    }
    transform(data, padded, true);
    return data;
  };
  std::vector<Complex> product = spectrum(f);
  const std::vector<Complex> other = spectrum(g);
  for (std::size_t i = 0; i < product.size(); ++i) product[i] = std::conj(product[i]) * other[i];
  transform(product, padded, false);
  const int reach = f.side - 1;
  Square lags(2 * reach + 1);
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      lags(x + reach, y + reach) =
          product[static_cast<std::size_t>((y + padded) % padded) * padded + (x + padded) % padded]
              .real();
    }
  }
  return lags;
}

bool is_in_view(std::int64_t x0, std::int64_t y0, int side, ImageView<const float> image) {
  return x0 >= 0 && y0 >= 0 && x0 + side <= image.width && y0 + side <= image.height;
}

}  // namespace

PublishedReference::PublishedReference(const FieldOptions& options)
    : options_(options),
      matrix_(cubic_interpolation_matrix(options.window_px, options.interp_points)) {}

WindowMotion PublishedReference::measure(ImageView<const float> first,
                                         ImageView<const float> second, const Window& window,
                                         double full_scale) const {
  const int side = options_.window_px, parts = options_.interp_points + 1;
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  const auto x1 = static_cast<std::int64_t>(window.x0) + window.guess_u;
  const auto y1 = static_cast<std::int64_t>(window.y0) + window.guess_v;
  if (!is_in_view(window.x0, window.y0, side, first) || !is_in_view(x1, y1, side, second)) {
    return without_motion(WindowStatus::kOutOfView, nothing);
  }
  const Square f = mean_free(first, window.x0, window.y0, side);
  const Square g = mean_free(second, static_cast<int>(x1), static_cast<int>(y1), side);
  const double contrast = min_contrast(options_, full_scale);
  const double lowest = contrast * contrast * static_cast<double>(f.values.size());
  if (energy_of(f) < lowest || energy_of(g) < lowest) {
    return without_motion(WindowStatus::kNoTexture, nothing);
  }
  const Square fine_f = interpolated(f, matrix_), fine_g = interpolated(g, matrix_);
  const Square map = cross_correlation(fine_f, fine_g);
  const auto best = std::max_element(map.values.begin(), map.values.end());
  const int at = static_cast<int>(best - map.values.begin()), reach = fine_f.side - 1;
  const int lag_x = at % map.side - reach, lag_y = at / map.side - reach;

  // The ratio of peaks is that of the map at whole pixels.
  Square coarse(2 * side - 1);
  for (int y = 0; y < coarse.side; ++y) {
    for (int x = 0; x < coarse.side; ++x) coarse(x, y) = map(x * parts, y * parts);
  }
  const auto highest = std::max_element(coarse.values.begin(), coarse.values.end());
  const int peak = static_cast<int>(highest - coarse.values.begin());
  const double other = second_peak(coarse.values, coarse.side, 0, coarse.side - 1, 0,
                                   coarse.side - 1, peak % coarse.side, peak / coarse.side);
  const double scale = 1 / std::sqrt(energy_of(fine_f) * energy_of(fine_g));
  WindowMotion motion{};
  motion.u = static_cast<float>(window.guess_u + static_cast<double>(lag_x) / parts);
  motion.v = static_cast<float>(window.guess_v + static_cast<double>(lag_y) / parts);
  motion.u_sd = motion.v_sd = static_cast<float>(1 / (parts * std::sqrt(12.0)));
  motion.correlation = static_cast<float>(*best * scale);
  motion.peak_ratio = static_cast<float>(peak_ratio(*highest, other));
  motion.status = static_cast<idic_int>(WindowStatus::kOk);
  return motion;
}

}  // namespace impactdic::dic
