// One pass of a ball's registration over its disc: what every pixel gives to the sums.
#ifndef IMPACTDIC_KERNELS_BALL_PASS_H_
#define IMPACTDIC_KERNELS_BALL_PASS_H_

#include "kernels/ball/registration.h"

// True where a coordinate that runs straight from `first` to `last` stays beyond the same border.
static inline int beyond(const float first, const float last, const float most) {
  return (first < 0.0f && last < 0.0f) || (first > most && last > most);
}

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
// value: the first picture's planes; second: coefficient of pixel (0, 0) of the second picture.
BARRIER_INLINE void pass(__global const float* value, __global const float* second,
                         __global const float* mask, const BallTask task, const Box box,
                         const BallLimits limits, __local float* scratch, __local Shared* shared) {
  (void)mask;
  const int item = (int)get_local_id(0);
  const size_t plane = (size_t)limits.height * limits.plane_pitch;
  const int units = unit_count(box);
  // Whole pixels apart, floats keep their digits for the position about the centre.
  const float whole_cx = rint(task.cx), whole_cy = rint(task.cy);
  const float rest_cx = task.cx - whole_cx, rest_cy = task.cy - whole_cy;
  const float whole_x = rint(shared->warp[4]), whole_y = rint(shared->warp[5]);
  const float t_x = rest_cx + (shared->warp[4] - whole_x);
  const float t_y = rest_cy + (shared->warp[5] - whole_y);
  const int base_x = (int)whole_cx + (int)whole_x, base_y = (int)whole_cy + (int)whole_y;
  __global const float* origin = second + base_y * limits.pitch + base_x;
  const float most_x = (float)(limits.width - 1), most_y = (float)(limits.height - 1);
  const float by_radius = 1.0f / task.radius;
  REAL sums[SUMS];
  for (int k = 0; k < SUMS; ++k) sums[k] = 0.0f;
  for (int unit = item; unit < units; unit += GROUP) {
    const int py = unit_y(box, unit), px = unit_x(box, unit);
#if VECTOR == 1
    if (px >= box.x1) continue;
#endif
    if (py >= box.y1) continue;
    const REAL x = LANE_NUMBERS + ((float)(px - (int)whole_cx) - rest_cx);
    const REAL y = (REAL)((float)(py - (int)whole_cy) - rest_cy);
    const REAL to_x = t_x + shared->warp[0] * x + shared->warp[1] * y;
    const REAL to_y = t_y + shared->warp[2] * x + shared->warp[3] * y;
    const REAL view_x = to_x + (float)base_x, view_y = to_y + (float)base_y;
    if (beyond(FIRST_LANE(view_x), LAST_LANE(view_x), most_x) ||
        beyond(FIRST_LANE(view_y), LAST_LANE(view_y), most_y)) {
      continue;
    }
    const REAL zero = 0.0f, one = 1.0f;
    REAL w = x * x + y * y < task.radius * task.radius ? one : zero;
    w = x + (rest_cx + whole_cx) < (float)box.x1 - 0.5f ? w : zero;
    w = fmin(view_x, most_x - view_x) >= 0.0f ? w : zero;
    w = fmin(view_y, most_y - view_y) >= 0.0f ? w : zero;
#if MASKED
    w *= LOAD_REAL(mask + (size_t)py * limits.plane_pitch + px);
#endif
#if VECTOR == 1
    if (w == 0.0f) continue;
#endif
    __global const float* at = value + (size_t)py * limits.plane_pitch + px;
    const REAL f = LOAD_REAL(at) - shared->origin;
    // Light is a factor: its gradients go with the grey level itself.
    const REAL along_x = (f + shared->origin) * x * by_radius;
    const REAL along_y = (f + shared->origin) * y * by_radius;
    const REAL slope_x = LOAD_REAL(at + plane), slope_y = LOAD_REAL(at + 2 * plane);
    const REAL g = spline_sample(origin, limits.pitch, to_x, to_y) - shared->origin;
    const REAL r = g - shared->light[0] - shared->light[1] * f - shared->light[2] * along_x -
                   shared->light[3] * along_y;
    if (shared->bin > 0.0f) count_residuals(r, w, shared->bin, shared->histogram);
    REAL newton = 1.0f;
    const REAL robust = shared->scale > 0.0f ? biweight(r, shared->scale, &newton) : one;
    sums[NEWTON] += w * newton;
    sums[CHANGE] += w * (robust - newton) * r * r;  // dw/d(log scale) = w − d(w r)/dr
    w *= robust;
    REAL column[COLUMNS];
    column[0] = 1.0f;
    column[1] = f;
    column[2] = along_x;
    column[3] = along_y;
#if PARAMETERS == 3
    column[4] = slope_x;
    column[5] = slope_y;
    column[6] = (slope_x * y - slope_y * x) * by_radius;
#else
    column[4] = slope_x;
    column[5] = slope_x * x * by_radius;
    column[6] = slope_x * y * by_radius;
    column[7] = slope_y;
    column[8] = slope_y * x * by_radius;
    column[9] = slope_y * y * by_radius;
#endif
    column[REGRESSORS] = r;
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
