// Cardinal B-splines of degree 3, 5 and 7 between pixels (Unser, Aldroubi and Eden 1993). A C
// subset that also compiles as C++; with a literal degree everything folds and unrolls.
//
// A picture is s(x, y) = Σ c(i, j) βⁿ(x − i) βⁿ(y − j). At x the n + 1 coefficients from
// floor(x) − (n − 1)/2 on count, with weights that depend on t = x − floor(x) alone.
#ifndef IMPACTDIC_KERNELS_SPLINE_H_
#define IMPACTDIC_KERNELS_SPLINE_H_

#include "kernels/vector.h"

// Coefficients that a picture keeps beyond each of its borders: enough for degree 7.
#define SPLINE_PAD 4
#define SPLINE_MAX_TAPS 8

// One pair of weights, mirror images of each other about t = 1/2: even ± u·odd.
#define SPLINE_PAIR(first, last, even, odd) \
  {                                         \
    const REAL even_ = (even);              \
    const REAL odd_ = u * (odd);            \
    (first) = even_ - odd_;                 \
    (last) = even_ + odd_;                  \
  }

// w[0 … degree]: weights at t in [0, 1). The pieces of βⁿ as polynomials in u = 2t − 1, exact
// fractions over 2ⁿ n!.
KERNEL_INLINE void spline_weights(const int degree, const REAL t, REAL* w) {
  const REAL u = 2.0f * t - 1.0f;
  const REAL s = u * u;
  if (degree == 3) {
    const float d = 1.0f / 48.0f;
    SPLINE_PAIR(w[0], w[3], 1.0f * d + 3.0f * d * s, 3.0f * d + 1.0f * d * s)
    SPLINE_PAIR(w[1], w[2], 23.0f * d - 3.0f * d * s, 15.0f * d - 3.0f * d * s)
  } else if (degree == 5) {
    const float d = 1.0f / 3840.0f;
    SPLINE_PAIR(w[0], w[5], (5.0f * d * s + 10.0f * d) * s + 1.0f * d,
                (1.0f * d * s + 10.0f * d) * s + 5.0f * d)
    SPLINE_PAIR(w[1], w[4], (-15.0f * d * s + 210.0f * d) * s + 237.0f * d,
                (-5.0f * d * s + 30.0f * d) * s + 375.0f * d)
    SPLINE_PAIR(w[2], w[3], (10.0f * d * s - 220.0f * d) * s + 1682.0f * d,
                (10.0f * d * s - 140.0f * d) * s + 770.0f * d)
  } else {
    const float d = 1.0f / 645120.0f;
    SPLINE_PAIR(w[0], w[7], ((7.0f * d * s + 35.0f * d) * s + 21.0f * d) * s + 1.0f * d,
                ((1.0f * d * s + 21.0f * d) * s + 35.0f * d) * s + 7.0f * d)
    SPLINE_PAIR(w[1], w[6], ((-35.0f * d * s + 665.0f * d) * s + 4935.0f * d) * s + 2179.0f * d,
                ((-7.0f * d * s + 21.0f * d) * s + 2555.0f * d) * s + 5047.0f * d)
    SPLINE_PAIR(w[2], w[5], ((63.0f * d * s - 2205.0f * d) * s + 25389.0f * d) * s + 60657.0f * d,
                ((21.0f * d * s - 399.0f * d) * s + 175.0f * d) * s + 68747.0f * d)
    SPLINE_PAIR(w[3], w[4], ((-35.0f * d * s + 1505.0f * d) * s - 30345.0f * d) * s + 259723.0f * d,
                ((-35.0f * d * s + 945.0f * d) * s - 13545.0f * d) * s + 91035.0f * d)
  }
}

// w[0 … degree]: derivatives of the weights by t, through dNⁿ_j/dt = Nⁿ⁻¹_{j−1} − Nⁿ⁻¹_j and the
// recursion of de Boor (1972) for the basis functions Nⁿ⁻¹ on unit knots.
KERNEL_INLINE void spline_slopes(const int degree, const REAL t, REAL* w) {
  w[0] = t * 0.0f + 1.0f;
  for (int k = 1; k < degree; ++k) {
    REAL carried = t * 0.0f;
    for (int j = 0; j < k; ++j) {
      const REAL share = w[j] / (float)k;
      w[j] = carried + ((float)(j + 1) - t) * share;
      carried = (t + (float)(k - 1 - j)) * share;
    }
    w[k] = carried;
  }
  w[degree] = w[degree - 1];
  for (int j = degree - 1; j > 0; --j) w[j] = w[j - 1] - w[j];
  w[0] = -w[0];
}

#ifdef __OPENCL_C_VERSION__

#if VECTOR > 1
#if SPLINE_DEGREE == 3
#define SPLINE_TAPS 4
#else
#define SPLINE_TAPS 8 /* of degree 5 two have no weight */
#endif
#define SPLINE_LINE VECTOR_JOIN(float, SPLINE_TAPS)

// s in lanes whose pixels lie anywhere, rows and columns from coefficient c on: each lane's taps
// are rows of their own, which are neighbours in memory. wx, wy: the lanes' weights.
KERNEL_INLINE REAL spline_sample_apart(__global const float* c, const int pitch, const INTEGER rows,
                                       const INTEGER columns, const REAL* wx, const REAL* wy) {
  int offset[VECTOR];
  float weights[SPLINE_TAPS][VECTOR], down[SPLINE_DEGREE + 1][VECTOR], sums[VECTOR];
  VECTOR_JOIN(vstore, VECTOR)(rows * pitch + columns, 0, offset);
#pragma unroll
  for (int i = 0; i < SPLINE_TAPS; ++i)
    STORE_REAL(i <= SPLINE_DEGREE ? wx[i] : (REAL)0.0f, weights[i]);
#pragma unroll
  for (int j = 0; j <= SPLINE_DEGREE; ++j) STORE_REAL(wy[j], down[j]);
#pragma unroll 1
  for (int lane = 0; lane < VECTOR; ++lane) {
    __global const float* from = c + offset[lane];
    SPLINE_LINE line = 0.0f;
#pragma unroll
    for (int j = 0; j <= SPLINE_DEGREE; ++j) {
      line += down[j][lane] * VECTOR_JOIN(vload, SPLINE_TAPS)(0, from + j * pitch);
    }
#if SPLINE_TAPS == 8
    line *= (SPLINE_LINE)(weights[0][lane], weights[1][lane], weights[2][lane], weights[3][lane],
                          weights[4][lane], weights[5][lane], weights[6][lane], weights[7][lane]);
    const float4 half_line = line.lo + line.hi;
#else
    const float4 half_line = line * (SPLINE_LINE)(weights[0][lane], weights[1][lane],
                                                  weights[2][lane], weights[3][lane]);
#endif
    const float2 pair = half_line.lo + half_line.hi;
    sums[lane] = pair.x + pair.y;
  }
  return LOAD_REAL(sums);
}
#endif

// s(x, y) in VECTOR pixels, x going up by about 1 from lane to lane. c: the coefficient of position
// (0, 0), rows `pitch` apart.
KERNEL_INLINE REAL spline_sample(__global const float* c, const int pitch, const REAL x,
                                 const REAL y) {
  const REAL floor_x = floor(x), floor_y = floor(y);
  REAL wx[SPLINE_MAX_TAPS], wy[SPLINE_MAX_TAPS];
  spline_weights(SPLINE_DEGREE, x - floor_x, wx);
  spline_weights(SPLINE_DEGREE, y - floor_y, wy);
  REAL sum = 0.0f;
#if VECTOR == 1
  c += ((int)floor_y - (SPLINE_DEGREE - 1) / 2) * pitch + (int)floor_x - (SPLINE_DEGREE - 1) / 2;
#pragma unroll
  for (int j = 0; j <= SPLINE_DEGREE; ++j) {
    float row = 0.0f;
#pragma unroll
    for (int i = 0; i <= SPLINE_DEGREE; ++i) row += wx[i] * c[j * pitch + i];
    sum += wy[j] * row;
  }
#else
  // Where floor(x) − lane and floor(y) are the same in all lanes, taps are neighbours in memory.
  const REAL step_x = floor_x - LANE_NUMBERS;
  const float low_x = LOWEST_LANE(step_x), low_y = LOWEST_LANE(floor_y);
  const float span_x = HIGHEST_LANE(step_x) - low_x, span_y = HIGHEST_LANE(floor_y) - low_y;
  c += ((int)low_y - (SPLINE_DEGREE - 1) / 2) * pitch + (int)low_x - (SPLINE_DEGREE - 1) / 2;
  if (span_x == 0.0f && span_y == 0.0f) {
#pragma unroll 1
    for (int j = 0; j <= SPLINE_DEGREE; ++j) {
      REAL row = 0.0f;
#pragma unroll
      for (int i = 0; i <= SPLINE_DEGREE; ++i) row += wx[i] * LOAD_REAL(c + j * pitch + i);
      sum += wy[j] * row;
    }
  } else {
    sum = spline_sample_apart(c, pitch, TO_INTEGER(floor_y - low_y), TO_INTEGER(floor_x - low_x),
                              wx, wy);
  }
#endif
  return sum;
}

#endif  // __OPENCL_C_VERSION__
#endif  // IMPACTDIC_KERNELS_SPLINE_H_
