// Grey levels along lines across a rim (host/circle/rim/rim_cast.cpp).
#ifndef IMPACTDIC_KERNELS_RIM_CAST_H_
#define IMPACTDIC_KERNELS_RIM_CAST_H_

#include "kernels/rim/rim.h"
#include "kernels/vector.h"

// Numbers of all lines of a rim in global memory, each a row of MAX_LINES.
#define LINE_ROWS (3 + RIM_SAMPLES)
#define COS(lines) (lines)
#define SIN(lines) ((lines) + MAX_LINES)
#define TURN(lines) ((lines) + 2 * MAX_LINES)
#define LEVEL(lines, k) ((lines) + (3 + (k)) * MAX_LINES)

// How the samples of a line lie: that at an excess of x lies x (per − x bend) beyond `at`.
typedef struct Course {
  float at, per, bend;
  int origin, to_v;
} Course;

BARRIER_INLINE Course course_of(const RimQuarter q, const int line, const float last_turn,
                                float* cos_, float* sin_, float* turn_) {
  const float det = q.a * q.c - q.b * q.b, per_c = 1.0f / q.c;
  const float x = q.u0 + q.u_step * (float)line;
  const float gradient = sqrt(q.c - det * x * x);
  const float y = (q.side * gradient - q.b * x) * per_c;
  const float outside = sqrt(x * x + y * y);
  const float per_outside = 1.0f / outside;
  const float slope = outside * gradient;  // of the excess along v, outwards
  const float order = q.u_step > 0.0f ? 1.0f : -1.0f;
  const float turn = 0.5f + 0.5f * order * q.side * x / y;
  Course course;
  course.per = q.side / slope;
  course.bend = 0.5f * per_outside * (1.0f - slope * slope) * course.per * course.per * course.per;
  course.at = y - q.v0;
  course.origin = q.origin + line * q.to_u;
  course.to_v = q.to_v;
  const int along_rows = q.turn % 2 == 0;
  *cos_ = (along_rows ? y : x) * per_outside;
  *sin_ = (along_rows ? x : y) * per_outside;
  *turn_ = clamp(turn, 0.0f, last_turn) + (float)q.turn;
  return course;
}

// By Catmull and Rom's cubic.
BARRIER_INLINE float sample_course(__global const PIXEL* picture, const Course course,
                                   const float excess) {
  const float at = course.at + excess * (course.per - excess * course.bend);
  const int whole = (int)at;
  const float t = at - (float)whole;
  __global const PIXEL* p = picture + course.origin + (whole - 1) * course.to_v;
  const float a = (float)p[0], b = (float)p[course.to_v], c = (float)p[2 * course.to_v],
              d = (float)p[3 * course.to_v];
  return b + 0.5f * t *
                 (c - a + t * (2.0f * a - 5.0f * b + 4.0f * c - d + t * (3.0f * (b - c) + d - a)));
}

// Distance of the rim from its centre in the direction φ.
BARRIER_INLINE float rim_at(const RimTask* task, const float c, const float s) {
  const float e_sq = task->e1 * task->e1 + task->e2 * task->e2, r_sq = task->r * task->r;
  const float along = task->e1 * (c * c - s * s) + task->e2 * 2.0f * c * s;
  return (r_sq - e_sq) / sqrt(r_sq + e_sq - 2.0f * task->r * along);
}

// Casts all lines, and every so many of a quarter deep: MAX_DEEP of RIM_DEEP samples each, from the
// outermost on, with the places of their middles in radii from the centre. Returns how many reach
// deep.
BARRIER_INLINE int cast_lines(__global const PIXEL* picture, const RimTask* task,
                              __constant const RimNumbers* n, __global float* lines,
                              __local float* deep, __local float* deep_x, __local float* deep_y,
                              __local short* deep_line) {
  const int item = (int)get_local_id(0);
  int first = 0, first_deep = 0;
  for (int k = 0; k < 4; ++k) {
    const RimQuarter q = task->quarter[k];
    for (int i = item; i < q.lines; i += GROUP) {
      const int line = first + i;
      float c, s, turn;
      const Course course = course_of(q, i, n->last_turn, &c, &s, &turn);
      COS(lines)[line] = c;
      SIN(lines)[line] = s;
      TURN(lines)[line] = turn;
#pragma unroll 1
      for (int m = 0; m < RIM_SAMPLES; ++m) {
        const float excess = (float)(m - RIM_INSIDE) * task->step;
        LEVEL(lines, m)[line] = task->sign * sample_course(picture, course, excess);
      }
      if (i % n->deep_every != 0) continue;
      const int at = first_deep + i / n->deep_every;
#pragma unroll 1
      for (int m = 0; m < RIM_DEEP; ++m) {
        const float excess = -task->deep_step * (float)(RIM_INSIDE + 1 + m);
        deep[at * RIM_DEEP + m] = task->sign * sample_course(picture, course, excess);
      }
      const float inside = ((float)RIM_INSIDE + 0.5f * (1.0f + RIM_DEEP)) * task->deep_step;
      const float middle = (rim_at(task, c, s) - inside) / task->r;
      deep_x[at] = middle * c;
      deep_y[at] = middle * s;
      deep_line[at] = (short)line;
    }
    first += q.lines;
    first_deep += (q.lines + n->deep_every - 1) / n->deep_every;
  }
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  return first_deep;
}

#endif  // IMPACTDIC_KERNELS_RIM_CAST_H_
