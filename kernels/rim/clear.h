// The lines that show background outside and ball inside, as shares of their contrast
// (host/circle/rim/rim_lines.cpp).
#ifndef IMPACTDIC_KERNELS_RIM_CLEAR_H_
#define IMPACTDIC_KERNELS_RIM_CLEAR_H_

#include "kernels/rim/levels.h"

// Numbers of the kept lines in global memory, each a row of MAX_LINES.
#define KEPT_ROWS (3 + RIM_SAMPLES)
#define KEPT_COS(kept) (kept)
#define KEPT_SIN(kept) ((kept) + MAX_LINES)
#define KEPT_WEIGHT(kept) ((kept) + 2 * MAX_LINES)
#define PROFILE(kept, k) ((kept) + (3 + (k)) * MAX_LINES)

// Of a line by itself: neither, what is no background outside, or ball inside, too.
#define LINE_BARE 0
#define LINE_BLOCKED 1
#define LINE_SHOWS 2

typedef struct Kept {
  int lines, breaks;
  int widest_gap;                // rad, the bits of a float
  short begin[RIM_SECTORS + 1];  // the first line of each sector
  int count[RIM_SECTORS];
} Kept;

// The background at a line, between the middles of two sectors.
BARRIER_INLINE float ground_at(const float turn, const float seen, const float usual,
                               __constant const RimNumbers* n, __local const Levels* levels) {
  const float place = turn * (0.25f * RIM_LEVEL_SECTORS) - 0.5f;
  const int sector = (int)floor(place);
  const float t = place - (float)sector;
  const float a = levels->ground[sector < 0 ? RIM_LEVEL_SECTORS - 1 : sector];
  const float b = levels->ground[sector + 1 < RIM_LEVEL_SECTORS ? sector + 1 : 0];
  if (fabs(a - b) < n->clear_tolerance * usual) return a + t * (b - a);
  return fabs(seen - a) < fabs(seen - b) ? a : b;
}

// Which of the lines are kept, in `kept_line`; of one work-item.
BARRIER_INLINE void choose_lines(__local const uchar* kind, const int count, const int cast,
                                 __constant const RimNumbers* n, __local short* kept_line,
                                 __local Kept* out) {
  const int gap = (int)(n->gap_of_rim * (float)cast);
  int kept = 0, breaks = 0;
  int blocked = -n->beside - 1;  // the last line with something else outside
  int shown = -1;                // the last line with ball inside, or something else outside
  for (int i = 0; i < count; ++i) {
    if (kind[i] == LINE_BLOCKED) {
      breaks += i - blocked > n->beside ? 1 : 0;
      blocked = shown = i;
      while (kept > 0 && kept_line[kept - 1] >= i - n->beside) --kept;
      continue;
    }
    if (i - blocked <= n->beside || kind[i] == LINE_BARE) continue;
    // Longer than ink makes: an obstacle as bright as the background.
    const int hidden = shown >= 0 && i - shown > gap;
    if (hidden) {
      while (kept > 0 && kept_line[kept - 1] > shown - n->beside_hidden) --kept;
      blocked = i + n->beside_hidden - n->beside - 1;
    }
    shown = i;
    if (!hidden) kept_line[kept++] = (short)i;
  }
  out->lines = kept;
  out->breaks = breaks;
}

// `wanted`: 0 where none is to be kept. None is where they are too few for a fit.
BARRIER_INLINE void keep_clear_lines(__global const float* lines, const int count, const int cast,
                                     const int wanted, __constant const RimNumbers* n,
                                     __local const Levels* levels, __global float* kept,
                                     __local uchar* kind, __local short* kept_line,
                                     __local Kept* out) {
  const int item = (int)get_local_id(0);
  const float usual = levels->usual, noise = levels->noise;
  for (int i = item; i < count; i += GROUP) {
    const float seen = LEVEL(lines, RIM_SAMPLES - 1)[i];
    const float ground = ground_at(TURN(lines)[i], seen, usual, n, levels);
    const float contrast = light_at(levels->light, COS(lines)[i], SIN(lines)[i]) - ground;
    const int clear = contrast > n->clear_contrast * usual &&
                      contrast > n->clear_contrast_noise * noise &&
                      fabs(seen - ground) < n->clear_tolerance * contrast + n->clear_noise * noise;
    const float inside = rise_of(lines, i) + seen - ground;
    const int shows = inside >= fmax(n->nothing * contrast, n->nothing_noise * noise);
    kind[i] = !clear ? LINE_BLOCKED : shows ? LINE_SHOWS : LINE_BARE;
  }
  for (int b = item; b < RIM_SECTORS; b += GROUP) out->count[b] = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0) {
    choose_lines(kind, count, cast, n, kept_line, out);
    if (!wanted || out->lines < n->least_lines) out->lines = 0;
    out->widest_gap = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int k = item; k < out->lines; k += GROUP) {
    const int i = kept_line[k];
    const float c = COS(lines)[i], s = SIN(lines)[i], turn = TURN(lines)[i];
    const float ground = ground_at(turn, LEVEL(lines, RIM_SAMPLES - 1)[i], usual, n, levels);
    const float contrast = light_at(levels->light, c, s) - ground;
    const float per = 1.0f / contrast, relative = contrast / usual;
    for (int m = 0; m < RIM_SAMPLES; ++m) {
      PROFILE(kept, m)[k] = (LEVEL(lines, m)[i] - ground) * per;
    }
    KEPT_COS(kept)[k] = c;
    KEPT_SIN(kept)[k] = s;
    KEPT_WEIGHT(kept)[k] = relative * relative;
    atomic_inc(&out->count[sector_of(turn, RIM_SECTORS)]);
    const int next = kept_line[k + 1 < out->lines ? k + 1 : 0];
    const float c2 = COS(lines)[next], s2 = SIN(lines)[next];
    const float along = c * c2 + s * s2;
    if (along <= n->narrow) {
      const float gap = atan2(c * s2 - s * c2, along);
      atomic_max(&out->widest_gap, as_int(gap < 0.0f ? gap + 2.0f * M_PI_F : gap));
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  if (item == 0) {
    out->begin[0] = 0;
    for (int b = 0; b < RIM_SECTORS; ++b) out->begin[b + 1] = out->begin[b] + out->count[b];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

#endif  // IMPACTDIC_KERNELS_RIM_CLEAR_H_
