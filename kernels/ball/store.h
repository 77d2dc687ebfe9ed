// What a ball's registration found, and its standard deviations.
#ifndef IMPACTDIC_KERNELS_BALL_STORE_H_
#define IMPACTDIC_KERNELS_BALL_STORE_H_

#include "kernels/ball/scores.h"

// Share of the slopes' power that smoothing them once more leaves, from every fourth pixel each
// way: the pictures' noise went through the same Gaussian, and reaches the motion through it.
BARRIER_INLINE float smoothed_share(__global const float* value, const Box box, const BallTask task,
                                    const BallLimits limits, __constant float* taps,
                                    __local float* scratch, __local Shared* shared) {
  if (SMOOTH_RADIUS == 0) return 1.0f;
  const int item = (int)get_local_id(0), reach = SMOOTH_RADIUS;
  const size_t plane = (size_t)limits.height * limits.plane_pitch;
  const int across = (box.x1 - box.x0 + 3) / 4, down = (box.y1 - box.y0 + 3) / 4;
  float power[2] = {0.0f, 0.0f};
  for (int k = item; k < across * down; k += GROUP) {
    const int px = box.x0 + 4 * (k % across), py = box.y0 + 4 * (k / across);
    const float x = (float)px - task.cx, y = (float)py - task.cy;
    if (x * x + y * y >= task.radius * task.radius) continue;
    if (px < reach || py < reach || px + reach >= limits.width || py + reach >= limits.height) {
      continue;
    }
    __global const float* at = value + plane + (size_t)py * limits.plane_pitch + px;
    float smooth_x = 0.0f, smooth_y = 0.0f;
#pragma unroll 1
    for (int j = -reach; j <= reach; ++j) {
#pragma unroll
      for (int i = -reach; i <= reach; ++i) {
        const float weight = taps[abs(i)] * taps[abs(j)];
        smooth_x += weight * at[j * limits.plane_pitch + i];
        smooth_y += weight * at[(size_t)plane + j * limits.plane_pitch + i];
      }
    }
    power[0] += at[0] * at[0] + at[plane] * at[plane];
    power[1] += smooth_x * smooth_x + smooth_y * smooth_y;
  }
  scratch[item] = power[0];
  scratch[REDUCE_PITCH + item] = power[1];
  sum_rows(2, scratch, shared->smoothed);
  return shared->smoothed[1] / shared->smoothed[0];
}

#if PARAMETERS != SPHERE
// Deviations of what blocks' scores say by chance, from which on they begin to count; wholly from
// twice as many on.
#define CHANCE 3.5f

// What residuals that err alike over whole blocks of pixels make of a variance by noise: `above`
// times as much, where that is beyond what the blocks' number lets it be by chance.
static inline float by_blocks(const float above, const float blocks) {
  const float chance = sqrt(2.0f / blocks);
  return 1.0f + (above - 1.0f) * clamp((above - 1.0f) / (CHANCE * chance) - 1.0f, 0.0f, 1.0f);
}

// Lane 0: standard deviations of dx, dy, rotation, exx, exy, eyy for the pixel deviation `scale`:
// each is a sum of two parameters with weights.
static inline void store_deviations(__global BallMotion* out, __local Shared* shared,
                                    const float radius, const float scale) {
  const float by_gain = shared->stretch / shared->light[1];
  const float blocks = shared->carried * (1.0f / (BLOCK_X * BLOCK_Y));
  __global float* deviation[] = {&out->dx_sd,  &out->dy_sd,  &out->rot_sd_rad,
                                 &out->exx_sd, &out->exy_sd, &out->eyy_sd};
  for (int k = 0; k < 15; ++k) out->covariance[k] = 0.0f;
  out->ball_radius = out->ball_radius_sd = out->by_distance = out->by_distance_sd = 0.0f;
#if PARAMETERS == 3
  const int parameter[] = {0, 1, 2}, other[] = {0, 1, 2};
  const float weight[] = {1.0f, 1.0f, 1.0f / radius}, other_weight[] = {0.0f, 0.0f, 0.0f};
  out->exx_sd = out->exy_sd = out->eyy_sd = 0.0f;
#else
  const float whole = 1.0f / radius, part = 0.5f / radius;
  const int parameter[] = {0, 3, 2, 1, 2, 5}, other[] = {0, 3, 4, 1, 4, 5};
  const float weight[] = {1.0f, 1.0f, part, whole, part, whole};
  const float other_weight[] = {0.0f, 0.0f, -part, 0.0f, part, 0.0f};
#endif
#pragma unroll 1
  for (int k = 0; k < PARAMETERS; ++k) {
    for (int i = 0; i < REGRESSORS; ++i) shared->solution[i] = 0.0f;
    shared->solution[LIGHT + parameter[k]] += weight[k];
    shared->solution[LIGHT + other[k]] += other_weight[k];
    const float by_noise =
        scale * scale * cholesky_quadratic(shared->sums, REGRESSORS, shared->solution);
    cholesky_solve(shared->sums, REGRESSORS, shared->solution);
    const float by_scores =
        by_gain * by_gain * sandwich(shared->scores, shared->solution, shared->solution);
    *deviation[k] = sqrt(by_noise * by_blocks(by_scores / by_noise, blocks));
  }
}

static inline void store_motion(__global BallMotion* out, __local const Shared* shared) {
  __local const float* w = shared->warp;
  const float turn = atan2(w[1] - w[2], w[0] + w[3]);
  out->dx = w[4];
  out->dy = w[5];
  out->rot_rad = turn;
  out->rot_x_rad = out->rot_y_rad = 0.0f;
#if PARAMETERS == 3
  out->exx = out->exy = out->eyy = 0.0f;
#else
  // A = R U, R the rotation and U symmetric.
  const float c = cos(turn), s = sin(turn);
  out->exx = c * w[0] - s * w[2] - 1.0f;
  out->eyy = s * w[1] + c * w[3] - 1.0f;
  out->exy = 0.5f * (c * w[1] - s * w[3] + s * w[0] + c * w[2]);
#endif
}
#endif  // PARAMETERS != SPHERE

static inline void store_failure(__global BallMotion* out) {
  out->dx = out->dy = out->rot_rad = NAN;
  out->exx = out->exy = out->eyy = NAN;
  out->dx_sd = out->dy_sd = out->rot_sd_rad = NAN;
  out->exx_sd = out->exy_sd = out->eyy_sd = NAN;
  out->rot_x_rad = out->rot_y_rad = NAN;
  for (int k = 0; k < 15; ++k) out->covariance[k] = NAN;
  out->ball_radius = out->ball_radius_sd = out->by_distance = out->by_distance_sd = NAN;
  out->cx = out->cy = out->cx_sd = out->cy_sd = NAN;
}

#endif  // IMPACTDIC_KERNELS_BALL_STORE_H_
