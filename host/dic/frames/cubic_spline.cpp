#include "host/dic/frames/cubic_spline.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace impactdic::dic {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Second derivatives at the knots as a matrix on the samples.
Matrix bends_of_samples(int n) {
  Matrix left = Matrix::Zero(n, n), right = Matrix::Zero(n, n);
  for (int i = 1; i + 1 < n; ++i) {
    // m[i−1] + 4 m[i] + m[i+1] = 6 (f[i−1] − 2 f[i] + f[i+1])
    left(i, i - 1) = left(i, i + 1) = 1;
    left(i, i) = 4;
    right(i, i - 1) = right(i, i + 1) = 6;
    right(i, i) = -12;
  }
  for (const auto& [row, first] : {std::pair(0, 0), std::pair(n - 1, n - 3)}) {
    left(row, first) = left(row, first + 2) = 1;
    left(row, first + 1) = -2;
  }
  return left.fullPivLu().solve(right);
}

}  // namespace

std::vector<double> cubic_interpolation_matrix(int samples, int points) {
  const int parts = points + 1, rows = (samples - 1) * parts + 1;
  const Matrix bends = bends_of_samples(samples);
  Matrix matrix = Matrix::Zero(rows, samples);
  for (int row = 0; row < rows; ++row) {
    const int knot = std::min(row / parts, samples - 2);
    const double t = static_cast<double>(row - knot * parts) / parts, s = 1 - t;
    matrix(row, knot) += s;
    matrix(row, knot + 1) += t;
    matrix.row(row) += (s * s * s - s) / 6 * bends.row(knot);
    matrix.row(row) += (t * t * t - t) / 6 * bends.row(knot + 1);
  }
  return {matrix.data(), matrix.data() + matrix.size()};
}

std::vector<double> lag_matrices(int window_px, int points) {
  const std::vector<double> matrix = cubic_interpolation_matrix(window_px, points);
  const int fine = static_cast<int>(matrix.size()) / window_px;
  const auto side = static_cast<std::size_t>(window_px);
  std::vector<double> all(static_cast<std::size_t>(2 * fine - 1) * side * side, 0.0);
  for (int lag = 1 - fine; lag < fine; ++lag) {
    double* out = all.data() + static_cast<std::size_t>(lag + fine - 1) * side * side;
    for (int i = std::max(0, -lag); i < std::min(fine, fine - lag); ++i) {
      const double* f = matrix.data() + static_cast<std::size_t>(i) * side;
      const double* g = matrix.data() + static_cast<std::size_t>(i + lag) * side;
      for (std::size_t a = 0; a < side; ++a) {
        // The spline's memory of far samples decays by 0.27 a pixel.
        if (std::abs(f[a]) < 1e-12) continue;
        for (std::size_t b = 0; b < side; ++b) out[a * side + b] += f[a] * g[b];
      }
    }
  }
  return all;
}

}  // namespace impactdic::dic
