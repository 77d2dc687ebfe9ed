// One Gauss–Newton step of a ball's registration from the sums of a pass: rigid with PARAMETERS 3,
// of a sphere with 5, affine with 6.
#ifndef IMPACTDIC_KERNELS_BALL_STEP_H_
#define IMPACTDIC_KERNELS_BALL_STEP_H_

#include "kernels/ball/registration.h"
#include "kernels/ball/turn.h"

// Σ a b − Σ a Σ b / Σ 1 of two columns, column >= other.
static inline float covariance(__local const float* sums, const int column, const int other) {
  return sums[TRIANGLE(column, other)] -
         sums[TRIANGLE(column, 0)] * sums[TRIANGLE(other, 0)] / sums[0];
}

// ZNCC under the weights, from the sums: g = r + Σ light · regressor.
static inline float correlation(__local const Shared* shared) {
  __local const float* s = shared->sums;
  float fg = covariance(s, REGRESSORS, 1), gg = covariance(s, REGRESSORS, REGRESSORS);
  for (int i = 1; i < LIGHT; ++i) {
    fg += shared->light[i] * covariance(s, i, 1);
    gg += 2.0f * shared->light[i] * covariance(s, REGRESSORS, i);
    for (int j = 1; j < LIGHT; ++j) {
      gg += shared->light[i] * shared->light[j] * covariance(s, max(i, j), min(i, j));
    }
  }
  return fg / sqrt(covariance(s, 1, 1) * gg);
}

#if FREE_DISTANCE
// Both pictures are seen from `by_distance`.
BARRIER_INLINE void see_from(__local Shared* shared, const float by_distance) {
  for (int k = 0; k < 2; ++k) {
    shared->seen[k].by_distance = by_distance;
    shared->seen[k].aside_x = by_distance * shared->away[k][0];
    shared->seen[k].aside_y = by_distance * shared->away[k][1];
  }
}
#endif

// Applies the solution to the warp. Returns the largest displacement of a pixel by it, px.
BARRIER_INLINE float move(__local Shared* shared, const float radius) {
  __local const float* s = shared->solution + LIGHT;
  const float by_gain = 1.0f / shared->light[1], by_both = by_gain / radius;
#if PARAMETERS == SPHERE
  const float du = s[0] * by_gain, dv = s[1] * by_gain;
  const float turn_x = s[2] * by_both, turn_y = s[3] * by_both, turn_z = s[4] * by_both;
  shared->warp[4] -= du;
  shared->warp[5] -= dv;
  turn_by(shared->turn, -turn_x, -turn_y, -turn_z);
#if FREE_RADIUS
  // Never so small that the disc that is compared reaches beyond it, nor so large that it could
  // reach the camera.
  shared->radius =
      clamp(shared->radius - s[5] * by_gain, radius + 0.5f, LARGEST_SPHERE * radius + 0.5f);
#endif
#if FREE_CENTRE
  shared->centre[0] -= s[MOVES - 2] * by_gain;
  shared->centre[1] -= s[MOVES - 1] * by_gain;
#endif
#if FREE_DISTANCE
  see_from(shared, clamp(shared->seen[0].by_distance - s[6] * by_both / radius, WIDEST / radius,
                         NEAREST / radius));
#endif
  return fmax(fabs(du), fabs(dv)) + (fabs(turn_x) + fabs(turn_y) + fabs(turn_z)) * radius;
#elif PARAMETERS == 3
  const float du = s[0] * by_gain, dv = s[1] * by_gain, turn = s[2] * by_both;
  warp_compose_inverse(shared->warp, cos(turn), sin(turn), -sin(turn), cos(turn), du, dv);
  return fmax(fabs(du), fabs(dv)) + fabs(turn) * radius;
#else
  const float du = s[0] * by_gain, ux = s[1] * by_both, uy = s[2] * by_both;
  const float dv = s[3] * by_gain, vx = s[4] * by_both, vy = s[5] * by_both;
  warp_compose_inverse(shared->warp, 1.0f + ux, uy, vx, 1.0f + vy, du, dv);
  return fmax(fabs(du) + radius * (fabs(ux) + fabs(uy)), fabs(dv) + radius * (fabs(vx) + fabs(vy)));
#endif
}

// Sums of PART_BINS bins of the histogram each, so that no single work-item adds up all of them.
BARRIER_INLINE void sum_bins(__local Shared* shared) {
  for (int part = (int)get_local_id(0); part < BINS / PART_BINS; part += GROUP) {
    int sum = 0;
    for (int k = 0; k < PART_BINS; ++k) sum += shared->histogram[part * PART_BINS + k];
    shared->parts[part] = sum;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// Median of |r| from the histogram, straight within its bin; as a normal deviation.
static inline float median_scale(__local const Shared* shared) {
  int total = 0;
  for (int part = 0; part < BINS / PART_BINS; ++part) total += shared->parts[part];
  const float middle = 0.5f * (float)total;
  int below = 0, part = 0;
  while (part < BINS / PART_BINS - 1 && (float)(below + shared->parts[part]) < middle) {
    below += shared->parts[part];
    ++part;
  }
  int k = part * PART_BINS;
  while (k < BINS - 1 && (float)(below + shared->histogram[k]) < middle) {
    below += shared->histogram[k];
    ++k;
  }
  const float within = (middle - (float)below) / (float)max(shared->histogram[k], 1);
  return 1.4826f * shared->bin * ((float)k + within);
}

#if FREE_CENTRE
// Adds to the sums what was told of the centre before the pictures, as one more row of the
// regression (a prior: Bayes' rule for normal errors). Before the first residuals a pixel is taken
// to err by one grey level of 255.
BARRIER_INLINE void tell_centre(__local Shared* shared, const BallTask task, const BallTask told,
                                const BallLimits limits) {
  const float least = limits.grey_level * limits.grey_level;
  const float variance = shared->variance > least ? shared->variance : least;
  const float by_gain = 1.0f / shared->light[1];
  shared->told = ALIKE * variance / (told.centre_sd * told.centre_sd);
  const float counts = shared->told / (shared->coarse ? COARSE_ROWS * COARSE_UNITS : 1);
  const float off[2] = {task.cx - told.cx, task.cy - told.cy};
  for (int k = 0; k < 2; ++k) {
    const int column = REGRESSORS - 2 + k;
    shared->sums[TRIANGLE(column, column)] += counts * by_gain * by_gain;
    shared->sums[TRIANGLE(REGRESSORS, column)] += counts * by_gain * off[k];
  }
}
#endif

// Lane 0: one Gauss–Newton step from the sums, and what the next pass is to do.
BARRIER_INLINE void step(__local Shared* shared, const BallTask task, const BallLimits limits) {
  __local float* sums = shared->sums;
  const float count = sums[0];
  const float area =
      compared_area(task, limits) / (shared->coarse ? COARSE_ROWS * COARSE_UNITS : 1);
  if (!(count > SMALLEST_SHARE * area)) {
    shared->status = shared->scale > 0.0f ? STATUS_LOW_CORRELATION : STATUS_OUT_OF_VIEW;
    return;
  }
  const float spread = covariance(sums, 1, 1);
  shared->kept =
      (sums[TRIANGLE(ALONG_X, ALONG_X)] + sums[TRIANGLE(ALONG_Y, ALONG_Y)]) / sums[TEXTURE];
  shared->carried = count;
  if (!shared->coarse) shared->correlation = correlation(shared);
  // The factor takes the place of the regressors' sums; those of r stand behind and stay.
  if (!(spread >= count * limits.min_contrast * limits.min_contrast) ||
      !cholesky(sums, REGRESSORS, SMALLEST_PIVOT)) {
    shared->status = STATUS_NO_TEXTURE;
    return;
  }
  __local const float* right = sums + TRIANGLE(REGRESSORS, 0);
  for (int k = 0; k < REGRESSORS; ++k) shared->solution[k] = right[k];
  cholesky_solve(sums, REGRESSORS, shared->solution);
  float residual = right[REGRESSORS];
  for (int k = 0; k < REGRESSORS; ++k) residual -= shared->solution[k] * right[k];
  const float scale =
      shared->bin > 0.0f ? fmax(median_scale(shared), SMALLEST_SCALE * limits.grey_level) : 0.0f;
  const float change = scale > 0.0f && shared->scale > 0.0f ? log(scale / shared->scale) : 0.0f;
  const float slight = clamp(change, -SAME_SCALE, SAME_SCALE);
  shared->carried = count + slight * (count - sums[NEWTON]);
  shared->variance = fmax(residual + slight * sums[CHANGE], 0.0f) / (shared->carried - REGRESSORS);
  const float stretch = clamp(count / sums[NEWTON], 1.0f, LONGEST_STRETCH);
  shared->stretch = stretch;
  for (int k = 0; k < REGRESSORS; ++k) shared->solution[k] *= stretch;
  for (int k = 0; k < LIGHT; ++k) shared->light[k] += shared->solution[k];
  if (!(shared->light[1] > 0.0f)) {
    shared->status = STATUS_LOW_CORRELATION;
    return;
  }
  const float moved = move(shared, task.radius);
  ++shared->steps;
  const float drift =
      fmax(fabs(shared->warp[4] - task.guess_dx), fabs(shared->warp[5] - task.guess_dy));
  const int settled =
      !limits.robust || (shared->scale > 0.0f && scale > 0.0f && fabs(change) <= SAME_SCALE);
  if (shared->moved > 0.0f) {
    shared->pace = clamp(moved / fmax(shared->moved, SHORTEST_STEP_PX), SMALLEST_PACE, 1.0f);
  }
  shared->moved = moved;
  if (!(drift <= 0.5f * task.radius)) {
    shared->status = STATUS_NOT_CONVERGED;
  } else if (!shared->coarse && settled && moved * shared->pace < LEFT_PX) {
    shared->status = STATUS_OK;
  }
  if (shared->bin > 0.0f) shared->scale = scale;
  shared->bin = limits.robust && moved < NEAR_PX
                    ? fmax(sqrt(shared->variance), 0.25f * limits.grey_level) / 32.0f
                    : 0.0f;
  if (shared->coarse && moved < COARSE_PX && (!limits.robust || shared->scale > 0.0f)) {
    shared->coarse = 0;
    shared->moved = 0.0f;  // other pixels, another minimum
  }
}

#endif  // IMPACTDIC_KERNELS_BALL_STEP_H_
