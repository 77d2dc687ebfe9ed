// The way up to the greatest likelihood of the lines (host/circle/rim/line_fit.cpp), of a frame
// that shares its rim model with others and lies where it is expected.
#ifndef IMPACTDIC_KERNELS_RIM_CLIMB_H_
#define IMPACTDIC_KERNELS_RIM_CLIMB_H_

#include "kernels/linalg.h"
#include "kernels/rim/evidence.h"

// What comes next.
#define CLIMB_SUM 0       // the sums at the new corrections
#define CLIMB_EVIDENCE 1  // a new round
#define CLIMB_THERE 2
#define CLIMB_LOST 3

typedef struct Climb {
  float delta[5];   // corrections of the rim, px
  float before[5];  // before the last step, where the sums are
  float about[5];   // about which the evidence is linear
  float last_way[5];
  float shares[RIM_KINDS];  // ln of the kinds' shares over those of the model
  float last_moved;
  int round, pass, careful, next;
  float curvature[TRIANGLE(5, 0)], right[5];  // memory of a step
} Climb;

// What is known beforehand of the corrections, as host/circle/rim/rim_prior.h has it; a circle's
// e1 and e2 are none.
typedef struct Known {
  float precision[5][5], pull[5];
} Known;

BARRIER_INLINE void add_known(Known* known, const float* direction, const float value,
                              const float sd) {
  const float weight = 1.0f / (sd * sd);
#pragma unroll 1
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) known->precision[i][j] += weight * direction[i] * direction[j];
    known->pull[i] += weight * value * direction[i];
  }
}

BARRIER_INLINE void know(const RimTask* task, __constant const RimNumbers* n,
                         __local const float* delta, const int ellipse, Known* known) {
#pragma unroll 1
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) known->precision[i][j] = 0.0f;
    known->pull[i] = 0.0f;
  }
  const float e1 = task->e1 + delta[3], e2 = task->e2 + delta[4];
  const float e = sqrt(e1 * e1 + e2 * e2);
  float u1 = e1 / (e + n->round_px), u2 = e2 / (e + n->round_px);
  if (ellipse && (task->axis1 != 0.0f || task->axis2 != 0.0f)) {
    u1 = task->axis1;
    u2 = task->axis2;
    const float across[5] = {0.0f, 0.0f, 0.0f, -u2, u1};
    add_known(known, across, u2 * task->e1 - u1 * task->e2, n->axis_tilt * e + n->axis_px);
  }
  if (task->radius_sd > 0.0f) {
    const float axis[5] = {0.0f, 0.0f, 1.0f, ellipse ? u1 : 0.0f, ellipse ? u2 : 0.0f};
    const float by_shape = ellipse ? u1 * task->e1 + u2 * task->e2 : 0.0f;
    const float wide = ellipse ? n->transverse * e : 0.0f;
    const float sd = sqrt(task->radius_sd * task->radius_sd + wide * wide);
    add_known(known, axis, task->radius_off - by_shape, fmax(sd, n->least_radius_sd));
  }
}

// Products of (cos φ, sin φ, 1, cos 2φ, sin 2φ) from sums by waves.
BARRIER_INLINE float product_of(__local const float* waves, const int i, const int j) {
  const int order[5] = {1, 1, 0, 2, 2}, sine[5] = {0, 1, 0, 0, 1};
  const int sum = order[i] + order[j], gap = order[i] - order[j], far = gap < 0 ? -gap : gap;
  const float sin_sum = sum > 0 ? waves[2 * sum] : 0.0f, sin_far = far > 0 ? waves[2 * far] : 0.0f;
  const float cos_sum = waves[max(2 * sum - 1, 0)], cos_far = waves[max(2 * far - 1, 0)];
  if (sine[i] && sine[j]) return 0.5f * (cos_far - cos_sum);
  if (!sine[i] && !sine[j]) return 0.5f * (cos_far + cos_sum);
  const float odd = (gap < 0 ? -1.0f : 1.0f) * (sine[i] ? sin_far : -sin_far);
  return 0.5f * (sin_sum + odd);
}

// How much wider the score scatters than that of independent lines (host/circle/rim/rim_prior.h).
BARRIER_INLINE float inflation(__local const LineSums* sums, __constant const RimNumbers* n,
                               const float per_px, const int parameters) {
  float between = 0.0f, common = 0.0f;
  int used = 0;
  const float per_sq = per_px * per_px;
  for (int b = 0; b < RIM_SECTORS; ++b) {
    const float score = per_px * sums->sector_score[b];
    const float share = n->common_px * per_sq * sums->sector_hessian[b];
    between += score * score;
    common += share * share;
    used += sums->sector_points[b] > 0 ? 1 : 0;
  }
  const float freedom = (float)used / (float)max(1, used - parameters);
  const float sum = fmax(per_sq * sums->of[5 + RIM_WAVES], 1e-30f);
  return fmax(1.0f, between * freedom / sum) + common / sum;
}

// The step to where gradient and curvature put the greatest likelihood; 0 where there is none.
BARRIER_INLINE int solve_step(const RimTask* task, __constant const RimNumbers* n,
                              __local const LineSums* sums, const float per_px, const float wider,
                              const float newton, const int ellipse, __local Climb* climb,
                              float* by) {
  Known known;
  know(task, n, climb->delta, ellipse, &known);
  const int row_of[5] = {1, 2, 0, 3, 4};  // of the scores by waves
  float full[5][5], gradient[5];
  __local const float* curvature = sums->of + 5;
  __local const float* hessian = sums->of + 5 + RIM_WAVES;
  const float per_sq = per_px * per_px / wider;
#pragma unroll 1
  for (int i = 0; i < 5; ++i) {
    gradient[i] = per_px * sums->of[row_of[i]] / wider + known.pull[i];
    for (int j = 0; j < 5; ++j) {
      const float usual = product_of(curvature, i, j);
      const float bent = usual + newton * (product_of(hessian, i, j) - usual);
      full[i][j] = per_sq * bent + known.precision[i][j];
      gradient[i] -= known.precision[i][j] * climb->delta[j];
    }
  }
  // A circle's e1 and e2 are where they must be.
  const float pinned[2] = {-task->e1 - climb->delta[3], -task->e2 - climb->delta[4]};
#pragma unroll 1
  for (int i = 0; i < 5; ++i) {
    const int is_pinned = !ellipse && i > 2;
    float right = is_pinned ? pinned[i - 3] : gradient[i];
    if (!ellipse && i < 3) right -= full[i][3] * pinned[0] + full[i][4] * pinned[1];
    climb->right[i] = right;
    for (int j = 0; j <= i; ++j) {
      climb->curvature[TRIANGLE(i, j)] = !is_pinned ? full[i][j] : i == j ? 1.0f : 0.0f;
    }
  }
  const int regular = cholesky(climb->curvature, 5, 1e-7f);
  if (regular) cholesky_solve(climb->curvature, 5, climb->right);
  for (int i = 0; i < 5; ++i) by[i] = climb->right[i];
  return regular;
}

BARRIER_INLINE float farthest(__local const Climb* climb, const float* by) {
  float far = 0.0f;
  for (int i = 0; i < 5; ++i) far = fmax(far, fabs(climb->delta[i] + by[i] - climb->about[i]));
  return far;
}

// The shares of the kinds at this rim over those of the model.
BARRIER_INLINE void learn_shares(__global const float* model, __constant const RimNumbers* n,
                                 __local const LineSums* sums, __local Climb* climb) {
#pragma unroll 1
  for (int k = 0; k < RIM_KINDS; ++k) {
    const float share = model[RIM_KINDS + k];
    const float here = sums->of[5 + 2 * RIM_WAVES + k] + n->share_worth * share;
    climb->shares[k] = log(here / (((float)sums->lines + n->share_worth) * share));
  }
}

// A step from the sums at climb->delta, of one work-item. `first`: of the two shapes.
BARRIER_INLINE void take_step(const RimTask* task, __global const float* model,
                              __constant const RimNumbers* n, __local const LineSums* sums,
                              const int ellipse, const int first, __local Climb* climb) {
  const float per_px = 1.0f / task->step, reach = n->reach * task->step;
  int points = 0;
  for (int b = 0; b < RIM_SECTORS; ++b) points += sums->sector_points[b];
  climb->next = CLIMB_LOST;
  const int parameters = ellipse ? 5 : 3;
  if (points < n->points_per_parameter * parameters) return;
  const int begins = first && climb->round == 0 && climb->pass == 0;
  const float wider = inflation(sums, n, per_px, parameters);
  const float convex = sums->of[5 + RIM_WAVES] / sums->of[5];
  const int there = convex > n->there;
  const float newton =
      climb->careful ? 0.0f : clamp((convex - n->fine_from) / n->fine_over, 0.0f, 1.0f);
  // The first step is a circle's: that finds its way from where an ellipse loses it.
  float by[5];
  if (!solve_step(task, n, sums, per_px, wider, newton, ellipse && !begins, climb, by)) return;
  const float far = farthest(climb, by);
  const int held = far > reach;
  float moved = 0.0f;
  for (int i = 0; i < 5; ++i) {
    const float from = climb->delta[i];
    climb->before[i] = from;
    if (held) by[i] = (from + by[i] - climb->about[i]) * (reach / far) + climb->about[i] - from;
    climb->delta[i] = from + by[i];
    moved = fmax(moved, fabs(by[i]));
  }
  if (!isfinite(moved)) return;
  if (begins) learn_shares(model, n, sums, climb);
  // What is left to go, if steps go on to shrink as they do.
  const float left = there ? moved * fmin(1.0f, moved / climb->last_moved) : moved;
  climb->last_moved = moved;
  const int goes_on = begins || left > n->settled * task->step;
  if (!held && goes_on && ++climb->pass < n->steps) {
    climb->next = CLIMB_SUM;
    return;
  }
  if (!held && as_float(sums->far) < n->near + n->relinearise) {
    climb->next = CLIMB_THERE;
    return;
  }
  float back = 0.0f;
  for (int i = 0; i < 5; ++i) {
    const float way = climb->delta[i] - climb->about[i];
    back += way * climb->last_way[i];
    climb->last_way[i] = way;
    climb->about[i] = climb->delta[i];
  }
  climb->careful = climb->careful || back < 0.0f;
  climb->last_moved = 1e-9f;
  climb->pass = 0;
  if (++climb->round < n->rounds) climb->next = CLIMB_EVIDENCE;
}

// Fits one shape, from no corrections or from where the other one left off: `first`.
BARRIER_INLINE void climb_up(const RimTask* task, __global const float* kept,
                             __global const float* model, __constant const RimNumbers* n,
                             __local const Kept* lines, const int ellipse, const int first,
                             __global float* evidence, __local float* score, __local float* hessian,
                             __local uchar* point, __local float* scratch, __local LineSums* sums,
                             __local Climb* climb, __global RimShape* out) {
  const int item = (int)get_local_id(0);
  const float per_px = 1.0f / task->step;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0) {
    climb->round = climb->pass = climb->careful = 0;
    climb->last_moved = first ? 1e-9f : n->newton * task->step;
    for (int i = 0; i < 5; ++i) {
      climb->delta[i] = first ? 0.0f : climb->before[i];
      if (first) climb->about[i] = 0.0f;
      climb->last_way[i] = 0.0f;
    }
    for (int k = 0; k < RIM_KINDS && first; ++k) climb->shares[k] = 0.0f;
    climb->next = first ? CLIMB_EVIDENCE : CLIMB_SUM;  // evidence is that of the other shape
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  int next = climb->next;
  while (next < CLIMB_THERE) {
    // No barrier stands in a branch: PoCL would make a copy of all that follows.
    if (next == CLIMB_EVIDENCE) {
      make_evidence(kept, lines->lines, model, n, per_px, climb->delta, evidence);
    }
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    const int begins = first && climb->round == 0 && climb->pass == 0;
    sum_lines(kept, evidence, model[0], per_px, climb->delta, climb->shares,
              begins ? n->preview_every : 1, lines, score, hessian, point, scratch, sums);
    if (item == 0) take_step(task, model, n, sums, ellipse, first, climb);
    barrier(CLK_LOCAL_MEM_FENCE);
    next = climb->next;
  }
  if (item == 0) {
    out->ok = next == CLIMB_THERE;
    for (int i = 0; i < 5; ++i) {
      out->delta[i] = climb->delta[i];
      out->before[i] = climb->before[i];
      out->score[i] = sums->of[i];
    }
    for (int m = 0; m < RIM_WAVES; ++m) {
      out->information[m] = sums->of[5 + m];
      out->hessian[m] = sums->of[5 + RIM_WAVES + m];
    }
    for (int k = 0; k < RIM_KINDS; ++k) {
      out->kinds[k] = sums->of[5 + 2 * RIM_WAVES + k];
      out->shares[k] = climb->shares[k];
    }
    out->scatter = sums->of[RIM_SUMS - 1];
    out->far = as_float(sums->far);
  }
  for (int b = item; b < RIM_SECTORS; b += GROUP) {
    out->sector_score[b] = sums->sector_score[b];
    out->sector_hessian[b] = sums->sector_hessian[b];
    out->sector_points[b] = sums->sector_points[b];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

#endif  // IMPACTDIC_KERNELS_RIM_CLIMB_H_
