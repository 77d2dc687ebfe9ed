// What a registration's residuals make of its covariance where they are neither alike nor
// independent (Liang and Zeger 1986, Theorem 2, with blocks of pixels as clusters).
#ifndef IMPACTDIC_KERNELS_BALL_SCORES_H_
#define IMPACTDIC_KERNELS_BALL_SCORES_H_

#if PARAMETERS == SPHERE
#include "kernels/ball/bend.h"
#endif
#include "kernels/ball/pass.h"
#include "kernels/ball/pixels.h"

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

#endif  // IMPACTDIC_KERNELS_BALL_SCORES_H_
