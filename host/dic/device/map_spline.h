// The quintic spline through a correlation map, as matrices.
#pragma once

#include <vector>

namespace impactdic::dic {

// The (n, n) matrix, row-major, that takes n >= 3 samples at 0 … n − 1 to the coefficients of the
// quintic B-spline through them, mirrored at the end samples (Unser, Aldroubi and Eden 1993).
std::vector<double> quintic_inverse(int n);

// Index of the coefficient that stands for number i of a line of n >= 2 mirrored at its ends.
int mirrored_index(int i, int n);

// Centred B-spline of `degree` at x, and its derivatives by x of order 0, 1 or 2.
double b_spline(int degree, double x, int derivative = 0);

}  // namespace impactdic::dic
