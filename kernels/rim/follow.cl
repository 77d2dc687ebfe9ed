#include "kernels/config.h"
#include "kernels/rim/climb.h"

// The rims of balls that lie where they are expected, by the rim model of earlier frames: lines
// across each (cast.h), the grey levels about it (levels.h), the lines that show both (clear.h),
// what these say (evidence.h), and the circle and ellipse of the greatest likelihood (climb.h). As
// host/circle/rim has it, which is the reference; whatever does not settle is left to that.
//
// pixels: (slots, height, width); model: RIM_MODEL numbers; room: for every task RIM_ROOM rows of
// MAX_LINES, which is at least its lines. One group a task.
#if LINE_ROWS + KEPT_ROWS + EVIDENCE_ROWS != RIM_ROOM
#error "RIM_ROOM does not hold a rim"
#endif

__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void follow_rims(
    __global const PIXEL* pixels, const int width, const int height, __global const RimTask* tasks,
    __global const float* model, __constant const RimNumbers* n, __global float* room,
    __global RimFound* found) {
  const size_t which = get_group_id(0);
  const int item = (int)get_local_id(0);
  __local float deep[MAX_DEEP * RIM_DEEP], deep_x[MAX_DEEP], deep_y[MAX_DEEP];
  __local short deep_line[MAX_DEEP], kept_line[MAX_LINES];
  __local float score[MAX_LINES], hessian[MAX_LINES];
  __local uchar kind[MAX_LINES];
  __local float scratch[REDUCE_SCRATCH];
  __local Levels levels;
  __local Kept clear;
  __local LineSums sums;
  __local Climb climb;
  const RimTask task = tasks[which];
  __global const PIXEL* picture = pixels + (size_t)task.slot * width * height;
  __global float* lines = room + which * RIM_ROOM * MAX_LINES;
  __global float* kept = lines + LINE_ROWS * MAX_LINES;
  __global float* evidence = kept + KEPT_ROWS * MAX_LINES;
  __global RimFound* out = found + which;

  int count = 0;
  for (int k = 0; k < 4; ++k) count += task.quarter[k].lines;
  const int reach_deep = cast_lines(picture, &task, n, lines, deep, deep_x, deep_y, deep_line);
  if (item == 0) levels.deep = reach_deep;
  barrier(CLK_LOCAL_MEM_FENCE);
  const int told = find_levels(lines, count, n, score, deep, deep_x, deep_y, deep_line, &levels);
  keep_clear_lines(lines, count, task.cast, told, n, &levels, kept, kind, kept_line, &clear);
  if (item == 0) {
    out->lines = clear.lines;
    out->breaks = clear.breaks;
    out->widest_gap = as_float(clear.widest_gap);
    out->noise = levels.noise;
    out->usual = levels.usual;
    for (int b = 0; b < RIM_LEVEL_SECTORS; ++b) out->ground[b] = levels.ground[b];
    for (int m = 0; m < 5; ++m) out->light[m] = levels.light[m];
  }
  const int shapes = task.oval ? 2 : 1;
  for (int k = 0; k < shapes; ++k) {
    const int ellipse = task.oval && k == 0;
    climb_up(&task, kept, model, n, &clear, ellipse, k == 0, evidence, score, hessian, kind,
             scratch, &sums, &climb, ellipse ? &out->oval : &out->circle);
  }
}
