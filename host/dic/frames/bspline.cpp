#include "host/dic/frames/bspline.h"

#include <cmath>
#include <vector>

#include "host/dic/frames/spline_taps.h"

namespace impactdic::dic {
namespace {

// Basis functions of `degree` on unit knots at t in [0, 1): Nʲ(t), j = 0 … degree.
std::array<double, 8> basis(int degree, double t) {
  std::array<double, 8> now{1.0};
  for (int k = 1; k <= degree; ++k) {
    std::array<double, 8> next{};
    for (int j = 0; j <= k; ++j) {
      // Piece j of degree k joins pieces j − 1 and j of degree k − 1.
      if (j > 0) next[j] += (t + (k - j)) / k * now[j - 1];
      if (j < k) next[j] += (j + 1 - t) / k * now[j];
    }
    now = next;
  }
  return now;
}

int mirror(int i, int size) {
  if (i >= 0 && i < size) return i;
  if (size == 1) return 0;
  const int period = 2 * (size - 1);
  i = std::abs(i) % period;
  return i < size ? i : period - i;
}

std::vector<double> poles(int degree) {
  if (degree == 3) return {std::sqrt(3.0) - 2.0};
  if (degree == 5) {
    return {std::sqrt(67.5 - std::sqrt(4436.25)) + std::sqrt(26.25) - 6.5,
            std::sqrt(67.5 + std::sqrt(4436.25)) - std::sqrt(26.25) - 6.5};
  }
  return {-0.53528043079643816554240378168164607, -0.12255461519232669051527226435935734,
          -0.00914869480960827692859370124490474};
}

void smooth_line(std::vector<double>& line, const std::vector<double>& taps) {
  const int size = static_cast<int>(line.size());
  std::vector<double> out(line.size());
  for (int i = 0; i < size; ++i) {
    double sum = taps[0] * line[i];
    for (int k = 1; k < static_cast<int>(taps.size()); ++k) {
      sum += taps[k] * (line[mirror(i - k, size)] + line[mirror(i + k, size)]);
    }
    out[i] = sum;
  }
  line = out;
}

// Causal and anticausal pass per pole (Unser, Aldroubi and Eden 1993, eqs 2.5 and 2.6).
void filter_line(std::vector<double>& line, const std::vector<double>& poles_of_degree) {
  const int size = static_cast<int>(line.size());
  if (size == 1) return;
  for (const double z : poles_of_degree) {
    for (double& c : line) c *= (1 - z) * (1 - 1 / z);
    // The mirrored line is periodic; its infinite causal sum over one period in closed form.
    double sum = line[0], power = z;
    for (int k = 1; k < 2 * (size - 1); ++k, power *= z) sum += power * line[mirror(k, size)];
    line[0] = sum / (1 - power);
    for (int k = 1; k < size; ++k) line[k] += z * line[k - 1];
    line[size - 1] = z / (z * z - 1) * (z * line[size - 2] + line[size - 1]);
    for (int k = size - 2; k >= 0; --k) line[k] = z * (line[k + 1] - line[k]);
  }
}

}  // namespace

std::array<double, 8> bspline_weights(int degree, double t) { return basis(degree, t); }

std::array<double, 8> bspline_slopes(int degree, double t) {
  const auto lower = basis(degree - 1, t);
  std::array<double, 8> slopes{};
  for (int j = 0; j <= degree; ++j) {
    slopes[j] = (j > 0 ? lower[j - 1] : 0.0) - (j < degree ? lower[j] : 0.0);
  }
  return slopes;
}

BSplineImage::BSplineImage(const Image<double>& picture, int degree, double presmooth_sigma_px)
    : degree_(degree), coefficients_(picture) {
  check_spline(degree, presmooth_sigma_px);
  const auto poles_of_degree = poles(degree);
  const auto taps = gaussian_taps(presmooth_sigma_px);
  std::vector<double> line(static_cast<std::size_t>(width()));
  for (int y = 0; y < height(); ++y) {
    line.assign(coefficients_.row(y), coefficients_.row(y) + width());
    smooth_line(line, taps);
    filter_line(line, poles_of_degree);
    std::copy(line.begin(), line.end(), coefficients_.row(y));
  }
  line.resize(static_cast<std::size_t>(height()));
  for (int x = 0; x < width(); ++x) {
    for (int y = 0; y < height(); ++y) line[y] = coefficients_(x, y);
    smooth_line(line, taps);
    filter_line(line, poles_of_degree);
    for (int y = 0; y < height(); ++y) coefficients_(x, y) = line[y];
  }
}

double BSplineImage::coefficient(int x, int y) const {
  return coefficients_(mirror(x, width()), mirror(y, height()));
}

double BSplineImage::value(double x_px, double y_px) const {
  const int x = static_cast<int>(std::floor(x_px)), y = static_cast<int>(std::floor(y_px));
  const auto wx = bspline_weights(degree_, x_px - x), wy = bspline_weights(degree_, y_px - y);
  const int x0 = x - (degree_ - 1) / 2, y0 = y - (degree_ - 1) / 2;
  double sum = 0;
  for (int j = 0; j <= degree_; ++j) {
    double row = 0;
    for (int i = 0; i <= degree_; ++i) row += wx[i] * coefficient(x0 + i, y0 + j);
    sum += wy[j] * row;
  }
  return sum;
}

BSplineImage::Sample BSplineImage::sample(double x_px, double y_px) const {
  const int x = static_cast<int>(std::floor(x_px)), y = static_cast<int>(std::floor(y_px));
  const auto wx = bspline_weights(degree_, x_px - x), wy = bspline_weights(degree_, y_px - y);
  const auto sx = bspline_slopes(degree_, x_px - x), sy = bspline_slopes(degree_, y_px - y);
  const int x0 = x - (degree_ - 1) / 2, y0 = y - (degree_ - 1) / 2;
  Sample sum{};
  for (int j = 0; j <= degree_; ++j) {
    double row = 0, row_slope = 0;
    for (int i = 0; i <= degree_; ++i) {
      const double c = coefficient(x0 + i, y0 + j);
      row += wx[i] * c;
      row_slope += sx[i] * c;
    }
    sum.value += wy[j] * row;
    sum.slope_x += wy[j] * row_slope;
    sum.slope_y += sy[j] * row;
  }
  return sum;
}

Image<double> to_double(const Frame& frame) {
  Image<double> out(frame.width(), frame.height());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out.data()[i] = frame.type == PixelType::kU8 ? frame.u8.data()[i] : frame.u16.data()[i];
  }
  return out;
}

}  // namespace impactdic::dic
