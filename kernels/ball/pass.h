// One pass of a ball's registration over its disc: what every pixel gives to the sums.
#ifndef IMPACTDIC_KERNELS_BALL_PASS_H_
#define IMPACTDIC_KERNELS_BALL_PASS_H_

#include "kernels/ball/pixels.h"

// Tukey's biweight w(r); newton: d(w r)/dr.
static inline REAL biweight(const REAL r, const float scale, REAL* newton) {
  const REAL u = r * (1.0f / (TUKEY * scale));
  const REAL rest = fmax(1.0f - u * u, (REAL)0.0f);
  *newton = rest * (1.0f - 5.0f * u * u);
  return rest * rest;
}

static inline void count_residuals(const REAL r, const REAL weight, const float bin,
                                   __local int* histogram) {
#if VECTOR == 1
  if (weight > 0.0f) atomic_inc(&histogram[min((int)(fabs(r) / bin), BINS - 1)]);
#else
  int bins[VECTOR];
  float weights[VECTOR];
  const REAL one = fmin(fabs(r) * (1.0f / bin), (REAL)(BINS - 1));
  VECTOR_JOIN(vstore, VECTOR)(TO_INTEGER(one), 0, bins);
  STORE_REAL(weight, weights);
  for (int lane = 0; lane < VECTOR; ++lane) {
    if (weights[lane] > 0.0f) atomic_inc(&histogram[bins[lane]]);
  }
#endif
}

// One pass over the disc: the weighted sums of products of all columns, and the histogram.
BARRIER_INLINE void pass(__global const float* value, __global const float* second,
                         __global const float* mask, const BallTask task, const Box box,
                         const BallLimits limits, __local float* scratch, __local Shared* shared) {
  const int item = (int)get_local_id(0);
  const int units = unit_count(box);
  const View view = view_of(task, shared->warp);
  REAL sums[SUMS];
  for (int k = 0; k < SUMS; ++k) sums[k] = 0.0f;
  for (int unit = item; unit < units; unit += GROUP) {
    REAL w, column[COLUMNS];
    if (!see_pixels(value, second, mask, view, task, box, limits, shared, unit_x(box, unit),
                    unit_y(box, unit), &w, column)) {
      continue;
    }
    const REAL r = column[REGRESSORS];
    if (shared->bin > 0.0f) count_residuals(r, w, shared->bin, shared->histogram);
    REAL newton = 1.0f, robust = 1.0f;
    if (shared->scale > 0.0f) robust = biweight(r, shared->scale, &newton);
    sums[NEWTON] += w * newton;
    sums[CHANGE] += w * (robust - newton) * r * r;  // dw/d(log scale) = w − d(w r)/dr
    sums[TEXTURE] += w * (column[ALONG_X] * column[ALONG_X] + column[ALONG_Y] * column[ALONG_Y]);
    w *= robust;
#pragma unroll
    for (int i = 0; i < COLUMNS; ++i) {
      const REAL weighted = w * column[i];
#pragma unroll
      for (int j = 0; j <= i; ++j) sums[TRIANGLE(i, j)] += weighted * column[j];
    }
  }
  GROUP_SUMS(sums, SUMS, scratch, shared->sums)
}

#endif  // IMPACTDIC_KERNELS_BALL_PASS_H_
