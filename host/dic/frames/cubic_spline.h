// Cubic spline interpolation between equally spaced samples, as a matrix.
#pragma once

#include <vector>

namespace impactdic::dic {

// The matrix, row-major, that takes `samples` >= 4 values at 0, 1, … to the values of the cubic
// spline through them at every 1/(points + 1): (samples − 1)(points + 1) + 1 rows, `samples`
// columns. At the ends the third derivative is continuous across the second knot (not-a-knot, de
// Boor 1978), so that cubics are reproduced exactly.
std::vector<double> cubic_interpolation_matrix(int samples, int points);

// Matrices A_l, l = −(M − 1) … M − 1 (M interpolated points a side, W pixels): (2M − 1, W, W),
// row-major. With f and g one line of each window before interpolation, fᵀ A_l g is the correlation
// Σ_i f↑(i) g↑(i + l) of the interpolated lines, so that in two dimensions
// c(l_x, l_y) = Σ f ∘ (A_{l_y} g A_{l_x}ᵀ) without interpolating anything.
std::vector<double> lag_matrices(int window_px, int points);

}  // namespace impactdic::dic
