// Quintic B-spline through samples at integers (Unser, Aldroubi and Eden 1993) on a short line.
#ifndef IMPACTDIC_KERNELS_MAP_SPLINE_H_
#define IMPACTDIC_KERNELS_MAP_SPLINE_H_

// Index of the coefficient that stands for number i of a line of n ≥ 2, which is mirrored at its
// end samples.
static inline int mirrored_index(const int i, const int n) {
  const int period = 2 * (n - 1);
  const int j = (i + 4 * period) % period;  // i is at least -8
  return j < n ? j : period - j;
}

// Value, first and second derivative at t of Σ c[k] t^k, k = 0 … 5.
static inline void quintic_polynomial(const float* c, const float t, float* value, float* slope,
                                      float* bend) {
  *value = c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))));
  *slope = c[1] + t * (2.0f * c[2] + t * (3.0f * c[3] + t * (4.0f * c[4] + t * 5.0f * c[5])));
  *bend = 2.0f * c[2] + t * (6.0f * c[3] + t * (12.0f * c[4] + t * 20.0f * c[5]));
}

// The weights of the coefficients −2 … 3 at the fraction t = 0 … 1 between samples 0 and 1, and
// their first and second derivatives by t. Six of each.
static inline void quintic_weights(const float t, float* weights, float* slopes, float* bends) {
  const float polynomials[6][6] = {{1, -5, 10, -10, 5, -1},  {26, -50, 20, 20, -20, 5},
                                   {66, 0, -60, 0, 30, -10}, {26, 50, 20, -20, -20, 10},
                                   {1, 5, 10, 10, 5, -5},    {0, 0, 0, 0, 0, 1}};
#pragma unroll
  for (int i = 0; i < 6; ++i) {
    quintic_polynomial(polynomials[i], t, weights + i, slopes + i, bends + i);
    weights[i] *= 1.0f / 120.0f;
    slopes[i] *= 1.0f / 120.0f;
    bends[i] *= 1.0f / 120.0f;
  }
}

#endif  // IMPACTDIC_KERNELS_MAP_SPLINE_H_
