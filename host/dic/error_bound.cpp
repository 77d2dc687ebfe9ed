#include "host/dic/error_bound.h"

#include <impactdic/error.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/dic/frames/bspline.h"
#include "host/dic/frames/spline_taps.h"

namespace impactdic::dic {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The slope at a pixel is Σ taps[k − 1] (p(k) − p(−k)), k = 1, 2, …: the spline's coefficients by
// their filter, times its slope at whole distances.
std::vector<float> slope_taps() {
  constexpr int kDegree = 5, kReach = (kDegree - 1) / 2;
  constexpr double kTolerance = 1e-4;
  const std::vector<double> filter = prefilter_taps(kDegree, 0, kTolerance);
  const auto slopes = bspline_slopes(kDegree, 0.0);
  const int radius = static_cast<int>(filter.size()) - 1;
  std::vector<float> taps;
  for (int k = 1; k <= radius + kReach; ++k) {
    double sum = 0;
    for (int j = -kReach; j <= kReach; ++j) {
      const int distance = std::abs(k - j);
      if (distance <= radius) {
        sum += slopes[static_cast<std::size_t>(j + kReach)] *
               filter[static_cast<std::size_t>(distance)];
      }
    }
    taps.push_back(static_cast<float>(sum));
  }
  return taps;
}

// Position `i` of `count` with the ends mirrored.
int mirrored(int i, int count) {
  if (count == 1) return 0;
  const int period = 2 * (count - 1);
  i = std::abs(i) % period;
  return std::min(i, period - i);
}

// Slopes of one line; `line` has taps.size() mirrored pixels before `count` of its own, and after.
void line_slopes(const float* line, int count, const std::vector<float>& taps, float* out) {
  std::fill(out, out + count, 0.0F);
  for (std::size_t t = 0; t < taps.size(); ++t) {
    const float weight = taps[t];
    const float* right = line + t + 1;
    const float* left = line - (t + 1);
    for (int i = 0; i < count; ++i) out[i] += weight * (right[i] - left[i]);
  }
}

Image<float> slopes_along_x(ImageView<const float> picture, const std::vector<float>& taps) {
  Image<float> slopes(picture.width, picture.height);
  const int pad = static_cast<int>(taps.size());
  std::vector<float> line(static_cast<std::size_t>(picture.width + 2 * pad));
  for (int y = 0; y < picture.height; ++y) {
    for (int x = -pad; x < picture.width + pad; ++x) {
      line[static_cast<std::size_t>(x + pad)] = picture(mirrored(x, picture.width), y);
    }
    line_slopes(line.data() + pad, picture.width, taps, slopes.row(y));
  }
  return slopes;
}

Image<float> slopes_along_y(ImageView<const float> picture, const std::vector<float>& taps) {
  Image<float> slopes(picture.width, picture.height, 0.0F);
  for (int y = 0; y < picture.height; ++y) {
    float* out = slopes.row(y);
    for (std::size_t t = 0; t < taps.size(); ++t) {
      const int k = static_cast<int>(t) + 1;
      const float* below = picture.row(mirrored(y + k, picture.height));
      const float* above = picture.row(mirrored(y - k, picture.height));
      for (int x = 0; x < picture.width; ++x) out[x] += taps[t] * (below[x] - above[x]);
    }
  }
  return slopes;
}

}  // namespace

PictureSlopes::PictureSlopes(ImageView<const float> picture, double noise)
    : width_(picture.width), height_(picture.height), noise_(noise * noise) {
  if (width_ < 1 || height_ < 1) throw InvalidArgument("the picture is empty");
  const std::vector<float> taps = slope_taps();
  for (const float tap : taps) slope_gain_ += 2.0 * tap * tap;
  slope_noise_ = slope_gain_ * noise_;
  slope_x_ = slopes_along_x(picture, taps);
  slope_y_ = slopes_along_y(picture, taps);
  sums_.assign(static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(height_ + 1), {});
  for (int y = 0; y < height_; ++y) {
    Sums row{};
    for (int x = 0; x < width_; ++x) {
      const double p = picture(x, y), gx = slope_x_(x, y), gy = slope_y_(x, y);
      row = {row.value + p, row.square + p * p, row.xx + gx * gx, row.xy + gx * gy,
             row.yy + gy * gy};
      const Sums& above = sums(x + 1, y);
      sums_[static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(width_ + 1) +
            static_cast<std::size_t>(x + 1)] = {above.value + row.value, above.square + row.square,
                                                above.xx + row.xx, above.xy + row.xy,
                                                above.yy + row.yy};
    }
  }
}

WindowBound PictureSlopes::window(int x0, int y0, int side, double noise) const {
  if (x0 < 0 || y0 < 0 || side < 1 || x0 + side > width_ || y0 + side > height_) {
    throw InvalidArgument("the window lies outside the picture");
  }
  const Sums &a = sums(x0, y0), &b = sums(x0 + side, y0);
  const Sums &c = sums(x0, y0 + side), &d = sums(x0 + side, y0 + side);
  const auto over = [&](double Sums::*part) { return d.*part - b.*part - c.*part + a.*part; };
  const double count = static_cast<double>(side) * side;
  const double mean = over(&Sums::value) / count;
  const double variance = over(&Sums::square) / count - mean * mean - noise_;
  const double xx = over(&Sums::xx) - count * slope_noise_;
  const double yy = over(&Sums::yy) - count * slope_noise_;
  const double xy = over(&Sums::xy), determinant = xx * yy - xy * xy;
  WindowBound bound{std::sqrt(std::max(0.0, variance)), kInfinity, kInfinity};
  if (xx > 0 && yy > 0 && determinant > 0) {
    bound.u_sd_px = noise * std::sqrt(2 * yy / determinant);
    bound.v_sd_px = noise * std::sqrt(2 * xx / determinant);
  }
  return bound;
}

WindowBound PictureSlopes::affine_window(int x0, int y0, int side, double noise) const {
  WindowBound bound = window(x0, y0, side, noise);
  const double half = (side - 1) / 2.0;
  // Σ g_a g_b (1, X, Y)(1, X, Y)ᵀ for (a, b) = xx, xy, yy, X and Y in units of the half side. Along
  // a row Y is the same: its sums are those over 1, X and X².
  Eigen::Matrix3d xx = Eigen::Matrix3d::Zero(), xy = xx, yy = xx;
  for (int y = 0; y < side; ++y) {
    const float* gx = slope_x_.row(y0 + y) + x0;
    const float* gy = slope_y_.row(y0 + y) + x0;
    Eigen::Array4d once = Eigen::Array4d::Zero(), by_x = once, by_xx = once;  // of xx, xy, yy
    for (int x = 0; x < side; ++x) {
      const Eigen::Array4d g(gx[x] * gx[x] - slope_noise_, gx[x] * gy[x],
                             gy[x] * gy[x] - slope_noise_, 0);
      const double at = (x - half) / half;
      once += g;
      by_x += at * g;
      by_xx += at * at * g;
    }
    const double at = (y - half) / half;
    const auto add_row = [&](int part, Eigen::Matrix3d& sum) {
      const double s = once[part], sx = by_x[part], sxx = by_xx[part];
      sum += (Eigen::Matrix3d() << s, sx, at * s, sx, sxx, at * sx, at * s, at * sx, at * at * s)
                 .finished();
    };
    add_row(0, xx);
    add_row(1, xy);
    add_row(2, yy);
  }
  Eigen::Matrix<double, 6, 6> information;
  information << xx, xy, xy, yy;
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factors(information);
  bound.u_sd_px = bound.v_sd_px = bound.expected_sd_px = kInfinity;
  if (factors.info() == Eigen::Success) {
    const Eigen::Matrix<double, 6, 6> covariance =
        2 * noise * noise * factors.solve(Eigen::Matrix<double, 6, 6>::Identity());
    bound.u_sd_px = std::sqrt(covariance(0, 0));
    bound.v_sd_px = std::sqrt(covariance(3, 3));
  }
  const double count = static_cast<double>(side) * side;
  const double interpolation = kInterpolationPx * kInterpolationPx * (xx(0, 0) + yy(0, 0)) / count;
  const double doubt = noise * noise + interpolation;
  const double moment = (side + 1.0) / (3.0 * (side - 1.0));
  const Vector6 shape = (Vector6() << 1, moment, moment, 1, moment, moment).finished();
  const Vector6 noise_share = count * slope_gain_ * doubt * shape;
  information.diagonal() -= count * slope_gain_ * interpolation * shape;
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> texture(information);
  if (texture.info() == Eigen::Success) {
    const auto deviation = [&](int column) {
      const Vector6 row = texture.solve(Vector6(Vector6::Unit(column)));
      return std::sqrt(2 * doubt * (row(column) + row.cwiseAbs2().dot(noise_share)));
    };
    bound.expected_sd_px = std::max(deviation(0), deviation(3));
  }
  return bound;
}

BallBound PictureSlopes::disc(double cx_px, double cy_px, double radius_px, double noise) const {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  const int top = std::max(0, static_cast<int>(std::ceil(cy_px - radius_px)));
  const int bottom = std::min(height_ - 1, static_cast<int>(std::floor(cy_px + radius_px)));
  for (int y = top; y <= bottom; ++y) {
    const double dy = y - cy_px, half = std::sqrt(std::max(0.0, radius_px * radius_px - dy * dy));
    const int left = std::max(0, static_cast<int>(std::ceil(cx_px - half)));
    const int right = std::min(width_ - 1, static_cast<int>(std::floor(cx_px + half)));
    for (int x = left; x <= right; ++x) {
      const double dx = x - cx_px, gx = slope_x_(x, y), gy = slope_y_(x, y);
      const Eigen::Vector3d slope(gx, gy, gx * dy - gy * dx);
      information += slope * slope.transpose();
      information.diagonal() -= slope_noise_ * Eigen::Vector3d(1, 1, dx * dx + dy * dy);
      // The noise of the turn's slope goes with that of the shifts.
      information(0, 2) -= slope_noise_ * dy;
      information(2, 0) -= slope_noise_ * dy;
      information(1, 2) += slope_noise_ * dx;
      information(2, 1) += slope_noise_ * dx;
    }
  }
  const Eigen::LLT<Eigen::Matrix3d> factors(information);
  if (factors.info() != Eigen::Success) return {kInfinity, kInfinity, kInfinity};
  const Eigen::Matrix3d covariance = 2 * noise * noise * factors.solve(Eigen::Matrix3d::Identity());
  return {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), std::sqrt(covariance(2, 2))};
}

}  // namespace impactdic::dic
