// What lines say under a rim model, and the sums of it (host/circle/rim/rim_evidence.cpp,
// line_sums.cpp).
#ifndef IMPACTDIC_KERNELS_RIM_EVIDENCE_H_
#define IMPACTDIC_KERNELS_RIM_EVIDENCE_H_

#include "kernels/reduce.h"
#include "kernels/rim/clear.h"

// Numbers of the evidence in global memory, each a row of MAX_LINES: the excess that it is exact
// at, and of every kind ln p, its slope and the information.
#define EVIDENCE_ROWS (1 + 3 * RIM_KINDS)
#define AT(evidence) (evidence)
#define VALUE(evidence, k) ((evidence) + (1 + (k)) * MAX_LINES)
#define SLOPE(evidence, k) ((evidence) + (1 + RIM_KINDS + (k)) * MAX_LINES)
#define INFORMATION(evidence, k) ((evidence) + (1 + 2 * RIM_KINDS + (k)) * MAX_LINES)

// Excesses with a table, per step of the lines.
#define RIM_PER_STEP(n) (0.5f / (n)->near)

// A model's quadratics in the profile, ln p or its slope, by kind. What is long and not often run
// stays a loop in these files, which is less for a driver to compile.
BARRIER_INLINE float8 form_of(__global const float* form, const float* profile,
                              const float weight) {
  float8 sum = vload8(0, form);
  int row = 1;
#pragma unroll 1
  for (int i = 0; i < RIM_SAMPLES; ++i) {
    sum += profile[i] * vload8(row++, form);
#pragma unroll 1
    for (int j = 0; j <= i; ++j) sum += profile[i] * profile[j] * vload8(row++, form);
  }
  sum.s0 *= weight;  // how much bare paint tells goes with the contrast
  return sum + vload8(RIM_FORMS, form);
}

// By kind, a row of MAX_LINES each.
BARRIER_INLINE void put_kinds(const float8 kinds, __global float* rows) {
  rows[0] = kinds.s0;
  rows[MAX_LINES] = kinds.s1;
  rows[2 * MAX_LINES] = kinds.s2;
  rows[3 * MAX_LINES] = kinds.s3;
  rows[4 * MAX_LINES] = kinds.s4;
  rows[5 * MAX_LINES] = kinds.s5;
  rows[6 * MAX_LINES] = kinds.s6;
  rows[7 * MAX_LINES] = kinds.s7;
}
BARRIER_INLINE float8 get_kinds(__global const float* rows) {
  return (float8)(rows[0], rows[MAX_LINES], rows[2 * MAX_LINES], rows[3 * MAX_LINES],
                  rows[4 * MAX_LINES], rows[5 * MAX_LINES], rows[6 * MAX_LINES],
                  rows[7 * MAX_LINES]);
}

// Excess of a line where the rim is moved by `shift`, steps.
BARRIER_INLINE float excess_of(const float c, const float s, __local const float* shift,
                               const float per_step) {
  return per_step * (c * shift[0] + s * shift[1] + shift[2] + (c * c - s * s) * shift[3] +
                     2.0f * c * s * shift[4]);
}

// The evidence of all lines about their excesses at `delta`, px; others may read it behind a
// barrier.
BARRIER_INLINE void make_evidence(__global const float* kept, const int count,
                                  __global const float* model, __constant const RimNumbers* n,
                                  const float per_px, __local const float* delta,
                                  __global float* evidence) {
  for (int i = (int)get_local_id(0); i < count; i += GROUP) {
    const float excess = excess_of(KEPT_COS(kept)[i], KEPT_SIN(kept)[i], delta, per_px);
    const float most = RIM_MODEL_REACH;
    const int place = (int)(clamp(RIM_PER_STEP(n) * excess, -most, most) + (most + 0.5f));
    AT(evidence)[i] = ((float)place - most) / RIM_PER_STEP(n);
    __global const float* table = model + RIM_MODEL_HEAD + place * RIM_TABLE;
    float profile[RIM_SAMPLES];
#pragma unroll 1
    for (int m = 0; m < RIM_SAMPLES; ++m) profile[m] = PROFILE(kept, m)[i];
    const float weight = KEPT_WEIGHT(kept)[i];
    float8 information = vload8(0, table + 2 * RIM_FORM);
    information.s0 *= weight;
#pragma unroll 1
    for (int k = 0; k < 2; ++k) {  // ln p and its slope: two copies take the compiler twice as long
      const float8 form = form_of(table + k * RIM_FORM, profile, weight);
      put_kinds(form, VALUE(evidence, k * RIM_KINDS) + i);
    }
    put_kinds(information, INFORMATION(evidence, 0) + i);
  }
}

BARRIER_INLINE float sum_of_kinds(const float8 v) {
  const float4 w = v.lo + v.hi;
  return (w.s0 + w.s1) + (w.s2 + w.s3);
}
BARRIER_INLINE float most_of_kinds(const float8 v) {
  const float4 w = fmax(v.lo, v.hi);
  return fmax(fmax(w.s0, w.s1), fmax(w.s2, w.s3));
}

// In the order of RimShape: scores, informations, hessians, kinds, scatter.
#define RIM_WAVES 9
#define RIM_SUMS (5 + 2 * RIM_WAVES + RIM_KINDS + 1)

// Sums over lines in local memory.
typedef struct LineSums {
  float of[RIM_SUMS];
  float sector_score[RIM_SECTORS], sector_hessian[RIM_SECTORS];
  int sector_points[RIM_SECTORS];
  int lines;
  int far;  // of a line from where its evidence is exact, at most, steps: the bits of a float
} LineSums;

// Lines that are summed together, of which a first step looks at one in so many.
#define LINE_BLOCK 8

// What the lines say at `delta`, or every so many blocks of them. `score`, `hessian`, `point`:
// memory for MAX_LINES of each.
BARRIER_INLINE void sum_lines(__global const float* kept, __global const float* evidence,
                              const float stray, const float per_px, __local const float* delta,
                              __local const float* shares, const int every,
                              __local const Kept* lines, __local float* score,
                              __local float* hessian, __local uchar* point, __local float* scratch,
                              __local LineSums* sums) {
  const int item = (int)get_local_id(0);
  if (item == 0) sums->far = sums->lines = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  float own[RIM_SUMS];
#pragma unroll
  for (int k = 0; k < RIM_SUMS; ++k) own[k] = 0.0f;
  float far = 0.0f;
  int own_lines = 0;
  const float8 share_of = vload8(0, shares);
  for (int i = item; i < lines->lines; i += GROUP) {
    if (i / LINE_BLOCK % every != 0) {
      score[i] = hessian[i] = 0.0f;
      point[i] = 0;
      continue;
    }
    ++own_lines;
    const float c = KEPT_COS(kept)[i], s = KEPT_SIN(kept)[i];
    const float off = excess_of(c, s, delta, per_px) - AT(evidence)[i];
    far = fmax(far, fabs(off));
    const float8 value = get_kinds(VALUE(evidence, 0) + i);
    const float8 at_slope = get_kinds(SLOPE(evidence, 0) + i);
    const float8 information = get_kinds(INFORMATION(evidence, 0) + i);
    const float8 slope = at_slope - off * information;
    float8 share = value + share_of + 0.5f * off * (at_slope + slope);
    const float most = fmax(most_of_kinds(share), stray);
    float other = exp(stray - most);
    share = exp(share - most);
    const float per_total = 1.0f / (sum_of_kinds(share) + other);
    other *= per_total;
    share *= per_total;
    const float8 first = share * slope;
    const float by_score = sum_of_kinds(first);
    const float by_information = sum_of_kinds(share * information);
    const float by_hessian = by_information - sum_of_kinds(first * slope) + by_score * by_score;
    const float error = slope.s0 / information.s0;
    const float c2 = c * c - s * s, s2 = 2.0f * c * s;
    const float waves[RIM_WAVES] = {
        1.0f, c, s, c2, s2, c * c2 - s * s2, s * c2 + c * s2, c2 * c2 - s2 * s2, 2.0f * c2 * s2};
#pragma unroll
    for (int m = 0; m < 5; ++m) own[m] += by_score * waves[m];
#pragma unroll
    for (int m = 0; m < RIM_WAVES; ++m) {
      own[5 + m] += by_information * waves[m];
      own[5 + RIM_WAVES + m] += by_hessian * waves[m];
    }
    own[5 + 2 * RIM_WAVES] += share.s0;
    own[6 + 2 * RIM_WAVES] += share.s1;
    own[7 + 2 * RIM_WAVES] += share.s2;
    own[8 + 2 * RIM_WAVES] += share.s3;
    own[9 + 2 * RIM_WAVES] += share.s4;
    own[10 + 2 * RIM_WAVES] += share.s5;
    own[11 + 2 * RIM_WAVES] += share.s6;
    own[12 + 2 * RIM_WAVES] += share.s7;
    own[RIM_SUMS - 1] += share.s0 * error * error;
    score[i] = by_score;
    hessian[i] = by_hessian;
    point[i] = other < 0.5f ? 1 : 0;
  }
  atomic_max(&sums->far, as_int(far));
  atomic_add(&sums->lines, own_lines);
  GROUP_SUMS(own, RIM_SUMS, scratch, sums->of);
  for (int b = item; b < RIM_SECTORS; b += GROUP) {
    float by_score = 0.0f, by_hessian = 0.0f;
    int points = 0;
    for (int i = lines->begin[b]; i < lines->begin[b + 1]; ++i) {
      by_score += score[i];
      by_hessian += hessian[i];
      points += point[i];
    }
    sums->sector_score[b] = by_score;
    sums->sector_hessian[b] = by_hessian;
    sums->sector_points[b] = points;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

#endif  // IMPACTDIC_KERNELS_RIM_EVIDENCE_H_
