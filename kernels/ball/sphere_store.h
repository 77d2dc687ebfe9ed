// The covariance of a sphere's registration, robust against residuals that are neither alike nor
// independent (Liang and Zeger 1986, Theorem 2, with blocks of pixels as clusters): near the rim
// foreshortening and the camera's blur make pictures differ by more than noise, over whole
// speckles.
#ifndef IMPACTDIC_KERNELS_BALL_SPHERE_STORE_H_
#define IMPACTDIC_KERNELS_BALL_SPHERE_STORE_H_

#include "kernels/ball/bend.h"
#include "kernels/ball/pixels.h"
#include "kernels/ball/step.h"
#include "kernels/ball/turn.h"

// Of a figure's variance by noise over that by scores: from where on texture is of few blocks, and
// from where on it is wholly.
#define FEW_FROM 1.5f
#define FEW_TO 1.9f

// Σ over blocks of the products of their scores Σ w ψ(r) column, into shared->scores; and what
// bends give to the right side of the last step, into shared->bent.
BARRIER_INLINE void sum_scores(__global const float* value, __global const float* second,
                               __global const float* mask, const BallTask task, const Box box,
                               const BallLimits limits, __local float* scratch,
                               __local Shared* shared) {
  const View view = view_of(task, shared->warp);
  const int across = max(0, (box.x1 - box.x0 + BLOCK_X - 1) / BLOCK_X);
  const int down = max(0, (box.y1 - box.y0 + BLOCK_Y - 1) / BLOCK_Y);
  REAL products[TRIANGLE(REGRESSORS, 0)];
  for (int k = 0; k < TRIANGLE(REGRESSORS, 0); ++k) products[k] = 0.0f;
#if BENDS
  const float share = bend_share(shared->turn) * shared->light[1];
  REAL bent[REGRESSORS];
  for (int i = 0; i < REGRESSORS; ++i) bent[i] = 0.0f;
#endif
  for (int block = (int)get_local_id(0); block < across * down; block += GROUP) {
    const int x0 = box.x0 + block % across * BLOCK_X, y0 = box.y0 + block / across * BLOCK_Y;
    REAL score[REGRESSORS];
    for (int i = 0; i < REGRESSORS; ++i) score[i] = 0.0f;
    for (int unit = 0; unit < BLOCK_X / VECTOR * BLOCK_Y; ++unit) {
      const int px = x0 + unit % (BLOCK_X / VECTOR) * VECTOR, py = y0 + unit / (BLOCK_X / VECTOR);
      REAL w, column[COLUMNS];
      if (!see_pixels(value, second, mask, view, task, box, limits, shared, px, py, &w, column))
        continue;
      REAL newton;
      if (shared->scale > 0.0f) w *= biweight(column[REGRESSORS], shared->scale, &newton);
#if BENDS
      if (share > 0.0f) {
        const REAL bend = w * bend_change(value, view, task, limits, shared, px, py);
#pragma unroll
        for (int i = 0; i < REGRESSORS; ++i) bent[i] += bend * column[i];
      }
#endif
      w *= column[REGRESSORS];
#pragma unroll
      for (int i = 0; i < REGRESSORS; ++i) score[i] += w * column[i];
    }
    float sum[REGRESSORS];
#pragma unroll
    for (int i = 0; i < REGRESSORS; ++i) sum[i] = SUM_LANES(score[i]);
#pragma unroll
    for (int i = 0; i < REGRESSORS; ++i) {
#pragma unroll
      for (int j = 0; j <= i; ++j) products[TRIANGLE(i, j)] += (REAL)(sum[i] * sum[j]);
    }
  }
  for (int k = 0; k < TRIANGLE(REGRESSORS, 0); ++k) products[k] *= 1.0f / VECTOR;
  GROUP_SUMS(products, TRIANGLE(REGRESSORS, 0), scratch, shared->scores)
#if BENDS
  for (int i = 0; i < REGRESSORS; ++i) bent[i] *= share;
  GROUP_SUMS(bent, REGRESSORS, scratch, shared->bent)
#endif
}

// a' B b for rows of the inverse and the packed scores.
BARRIER_INLINE float sandwich(__local const float* scores, __local const float* a,
                              __local const float* b) {
  float sum = 0.0f;
  for (int i = 0; i < REGRESSORS; ++i) {
    for (int j = 0; j < REGRESSORS; ++j) {
      sum += a[i] * scores[TRIANGLE(max(i, j), min(i, j))] * b[j];
    }
  }
  return sum;
}

#if BENDS
// Lane 0: takes off the motion what bends have made of it: one more step, with the last one's
// weights. shared->inverse is set.
BARRIER_INLINE void unbend(__local Shared* shared, const float radius) {
  for (int k = 0; k < MOVES; ++k) {
    float sum = 0.0f;
    for (int i = 0; i < REGRESSORS; ++i) {
      sum += shared->inverse[k * REGRESSORS + i] * shared->bent[i];
    }
    shared->solution[LIGHT + k] = -shared->stretch * sum;
  }
  move(shared, radius);
}
#endif

// Lane 0: the motion and its covariance. `rounding`: variance of a pixel that a residual need not
// show. shared->sums holds the factor of the last step's normal matrix.
BARRIER_INLINE void store_sphere(__global BallMotion* out, __local Shared* shared,
                                 const float radius, const float centre_sd, const float rounding) {
  const float by_gain = 1.0f / shared->light[1];
  const float unit[PARAMETERS] = {by_gain, by_gain, by_gain / radius, by_gain / radius,
                                  by_gain / radius};
#pragma unroll 1
  for (int k = 0; k < MOVES; ++k) {
    for (int i = 0; i < REGRESSORS; ++i) shared->solution[i] = i == LIGHT + k ? 1.0f : 0.0f;
    cholesky_solve(shared->sums, REGRESSORS, shared->solution);
    for (int i = 0; i < REGRESSORS; ++i) {
      shared->inverse[k * REGRESSORS + i] = shared->solution[i];
    }
  }
#if BENDS
  unbend(shared, radius);
#endif
#if FREE_CENTRE
  // The error of what was told of the centre.
  const float told = shared->told * by_gain * centre_sd;
  for (int k = REGRESSORS - 2; k < REGRESSORS; ++k) shared->scores[TRIANGLE(k, k)] += told * told;
#endif
  // Where few blocks hold all of the texture the fit makes their scores vanish: what they say is
  // far below what noise of the residuals' size leaves, and that is taken. Much fine texture is
  // told by its scores, which are a little below it.
  float more[PARAMETERS];
#pragma unroll 1
  for (int k = 0; k < PARAMETERS; ++k) {
    __local const float* row = shared->inverse + k * REGRESSORS;
    const float by_noise = ALIKE * shared->variance * row[LIGHT + k];
    const float above = by_noise / sandwich(shared->scores, row, row);
    const float few = clamp((above - FEW_FROM) * (1.0f / (FEW_TO - FEW_FROM)), 0.0f, 1.0f);
    more[k] = sqrt(1.0f + few * (above - 1.0f));
    for (int j = 0; j <= k; ++j) {
      const float found =
          more[k] * more[j] * sandwich(shared->scores, row, shared->inverse + j * REGRESSORS);
      out->covariance[TRIANGLE(k, j)] =
          unit[k] * unit[j] *
          (shared->stretch * shared->stretch * found + rounding * row[LIGHT + j]);
    }
  }
  out->ball_radius = shared->radius;
  out->ball_radius_sd = 0.0f;
  out->by_distance = out->by_distance_sd = 0.0f;
#if FREE_RADIUS
  __local const float* of_radius = shared->inverse + PARAMETERS * REGRESSORS;
  out->ball_radius_sd = by_gain * sqrt(shared->stretch * shared->stretch *
                                           sandwich(shared->scores, of_radius, of_radius) +
                                       rounding * of_radius[LIGHT + PARAMETERS]);
#endif
  out->cx = shared->centre[0];
  out->cy = shared->centre[1];
  out->cx_sd = out->cy_sd = 0.0f;
#if !FREE_CENTRE
  (void)centre_sd;
#else
  __local const float* of_x = shared->inverse + (MOVES - 2) * REGRESSORS;
  __local const float* of_y = shared->inverse + (MOVES - 1) * REGRESSORS;
  const float found_part = shared->stretch * shared->stretch;
  out->cx_sd = by_gain * sqrt(found_part * sandwich(shared->scores, of_x, of_x) +
                              rounding * of_x[LIGHT + MOVES - 2]);
  out->cy_sd = by_gain * sqrt(found_part * sandwich(shared->scores, of_y, of_y) +
                              rounding * of_y[LIGHT + MOVES - 1]);
#endif
#if SHAPED
  out->by_distance = shared->seen[0].by_distance;
#endif
#if FREE_DISTANCE
  __local const float* of_distance = shared->inverse + (PARAMETERS + 1) * REGRESSORS;
  out->by_distance_sd =
      by_gain / (radius * radius) *
      sqrt(shared->stretch * shared->stretch * sandwich(shared->scores, of_distance, of_distance) +
           rounding * of_distance[LIGHT + PARAMETERS + 1]);
#endif
  float turn[3];
  rotation_vector(shared->turn, turn);
  out->dx = shared->warp[4];
  out->dy = shared->warp[5];
  out->rot_x_rad = turn[0];
  out->rot_y_rad = turn[1];
  out->rot_rad = turn[2];
  out->dx_sd = sqrt(out->covariance[TRIANGLE(0, 0)]);
  out->dy_sd = sqrt(out->covariance[TRIANGLE(1, 1)]);
  out->rot_sd_rad = sqrt(out->covariance[TRIANGLE(4, 4)]);
  out->exx = out->exy = out->eyy = 0.0f;
  out->exx_sd = out->exy_sd = out->eyy_sd = 0.0f;
}

#endif  // IMPACTDIC_KERNELS_BALL_SPHERE_STORE_H_
