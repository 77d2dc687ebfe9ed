// What a registration's residuals make of its covariance where they are neither alike nor
// independent (Liang and Zeger 1986, Theorem 2, with blocks of pixels as clusters).
#ifndef IMPACTDIC_KERNELS_BALL_SCORES_H_
#define IMPACTDIC_KERNELS_BALL_SCORES_H_

#if PARAMETERS == SPHERE
#include "kernels/ball/bend.h"
#endif
#include "kernels/ball/pass.h"
#include "kernels/ball/pixels.h"

// Work-items side by side that share a block, so that what they read lies side by side, too; and
// blocks that a group has in hand at once.
#if VECTOR == 1 && GROUP >= 8
#define SHARERS 8
#else
#define SHARERS 1
#endif
#define BLOCKS_AT_ONCE (GROUP / SHARERS)

#if SHARERS > 1
// Their scores, one row a regressor and block, whose last element is the row's sum.
#define SCORE_ROW (SHARERS + 1)
#define SCORE_SCRATCH (REGRESSORS * BLOCKS_AT_ONCE * SCORE_ROW) /* floats */

// The products of the blocks' scores, which their sharers hold, join shared->scores, where this
// work-item keeps every GROUP-th from `item` on. Every work-item of the group must call it.
BARRIER_INLINE void add_products(const float* score, __local float* scratch,
                                 __local Shared* shared) {
  const int item = (int)get_local_id(0);
  const int block = item / SHARERS, sharer = item % SHARERS;
#pragma unroll
  for (int i = 0; i < REGRESSORS; ++i) {
    scratch[(i * BLOCKS_AT_ONCE + block) * SCORE_ROW + sharer] = score[i];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int row = item; row < REGRESSORS * BLOCKS_AT_ONCE; row += GROUP) {
    float sum = 0.0f;
    for (int k = 0; k < SHARERS; ++k) sum += scratch[row * SCORE_ROW + k];
    scratch[row * SCORE_ROW + SHARERS] = sum;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int k = item; k < TRIANGLE(REGRESSORS, 0); k += GROUP) {
    int i = 0;
    while (TRIANGLE(i + 1, 0) <= k) ++i;
    const int j = k - TRIANGLE(i, 0);
    float sum = 0.0f;
    for (int b = 0; b < BLOCKS_AT_ONCE; ++b) {
      sum += scratch[(i * BLOCKS_AT_ONCE + b) * SCORE_ROW + SHARERS] *
             scratch[(j * BLOCKS_AT_ONCE + b) * SCORE_ROW + SHARERS];
    }
    shared->scores[k] += sum;
  }
}
#else
#define SCORE_SCRATCH 1
#endif

// Σ over blocks of the products of their scores Σ w ψ(r) column, into shared->scores; and what
// bends give to the right side of the last step, into shared->bent.
BARRIER_INLINE void sum_scores(__global const float* value, __global const float* second,
                               __global const float* mask, const BallTask task, const Box box,
                               const BallLimits limits, __local float* scratch,
                               __local Shared* shared) {
  const View view = view_of(task, shared->warp);
  const int item = (int)get_local_id(0);
  const int across = max(0, (box.x1 - box.x0 + BLOCK_X - 1) / BLOCK_X);
  const int down = max(0, (box.y1 - box.y0 + BLOCK_Y - 1) / BLOCK_Y);
#if SHARERS > 1
  for (int k = item; k < TRIANGLE(REGRESSORS, 0); k += GROUP) shared->scores[k] = 0.0f;
#else
  REAL products[TRIANGLE(REGRESSORS, 0)];
  for (int k = 0; k < TRIANGLE(REGRESSORS, 0); ++k) products[k] = 0.0f;
#endif
#if BENDS
  const float share = bend_share(shared->turn) * shared->light[1];
  REAL bent[REGRESSORS];
  for (int i = 0; i < REGRESSORS; ++i) bent[i] = 0.0f;
#endif
  for (int first = 0; first < across * down; first += BLOCKS_AT_ONCE) {
    const int block = first + item / SHARERS;
    const int x0 = box.x0 + block % across * BLOCK_X, y0 = box.y0 + block / across * BLOCK_Y;
    REAL score[REGRESSORS];
    for (int i = 0; i < REGRESSORS; ++i) score[i] = 0.0f;
    for (int unit = item % SHARERS; unit < BLOCK_X / VECTOR * BLOCK_Y; unit += SHARERS) {
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
#if SHARERS > 1
    add_products(score, scratch, shared);
#else
    float sum[REGRESSORS];
#pragma unroll
    for (int i = 0; i < REGRESSORS; ++i) sum[i] = SUM_LANES(score[i]);
#pragma unroll
    for (int i = 0; i < REGRESSORS; ++i) {
#pragma unroll
      for (int j = 0; j <= i; ++j) products[TRIANGLE(i, j)] += (REAL)(sum[i] * sum[j]);
    }
#endif
  }
#if SHARERS > 1
  barrier(CLK_LOCAL_MEM_FENCE);
#else
  for (int k = 0; k < TRIANGLE(REGRESSORS, 0); ++k) products[k] *= 1.0f / VECTOR;
  GROUP_SUMS(products, TRIANGLE(REGRESSORS, 0), scratch, shared->scores)
#endif
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
