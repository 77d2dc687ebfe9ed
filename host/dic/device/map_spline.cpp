#include "host/dic/device/map_spline.h"

#include <Eigen/Dense>
#include <cmath>
#include <cstdlib>

namespace impactdic::dic {

int mirrored_index(int i, int n) {
  const int period = 2 * (n - 1);
  const int j = std::abs(i) % period;
  return j < n ? j : period - j;
}

double b_spline(int degree, double x, int derivative) {
  if (derivative > 0) {
    return b_spline(degree - 1, x + 0.5, derivative - 1) -
           b_spline(degree - 1, x - 0.5, derivative - 1);
  }
  // Sum of truncated powers (Schoenberg 1946).
  double sum = 0, binomial = 1, factorial = 1;
  for (int k = 0; k <= degree + 1; ++k) {
    const double from_knot = x + (degree + 1) / 2.0 - k;
    if (from_knot > 0) sum += (k % 2 ? -1 : 1) * binomial * std::pow(from_knot, degree);
    binomial *= static_cast<double>(degree + 1 - k) / (k + 1);
    if (k >= 1 && k <= degree) factorial *= k;
  }
  return sum / factorial;
}

std::vector<double> quintic_inverse(int n) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Matrix samples = Matrix::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    for (int k = -2; k <= 2; ++k) samples(i, mirrored_index(i + k, n)) += b_spline(5, k);
  }
  const Matrix inverse = samples.inverse();
  return {inverse.data(), inverse.data() + inverse.size()};
}

}  // namespace impactdic::dic
