// The motion of a sphere's registration, and its covariance by scores: near the rim foreshortening
// and the camera's blur make pictures differ by more than noise, over whole speckles.
#ifndef IMPACTDIC_KERNELS_BALL_SPHERE_STORE_H_
#define IMPACTDIC_KERNELS_BALL_SPHERE_STORE_H_

#include "kernels/ball/scores.h"
#include "kernels/ball/step.h"
#include "kernels/ball/turn.h"

// Of a figure's variance by noise over that by scores: from where on texture is of few blocks, and
// from where on it is wholly.
#define FEW_FROM 1.5f
#define FEW_TO 1.9f

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
