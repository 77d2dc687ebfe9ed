// The levels of background and bare paint about a rim (host/circle/rim/rim_levels.cpp).
#ifndef IMPACTDIC_KERNELS_RIM_LEVELS_H_
#define IMPACTDIC_KERNELS_RIM_LEVELS_H_

#include "kernels/linalg.h"
#include "kernels/rim/cast.h"
#include "kernels/rim/quantile.h"

// What is found, and memory for it.
typedef struct Levels {
  float ground[RIM_LEVEL_SECTORS];  // first the medians, by sector
  float light[5];
  float noise, usual, ground_median;
  float scalar;                      // of whoever looks for one
  int count[RIM_LEVEL_SECTORS + 1];  // of a sector's lines, or deep lines
  int begin[RIM_LEVEL_SECTORS + 1];  // the first of them
  float medians[RIM_LEVEL_SECTORS];
  float weight[RIM_LEVEL_SECTORS], weighted[RIM_LEVEL_SECTORS];
  float basis[RIM_LEVEL_SECTORS][5];
  float normal[TRIANGLE(5, 0)], right[5];
  int deep;  // lines that reach deep
} Levels;

BARRIER_INLINE int sector_of(const float turn, const int of) {
  return (int)(turn * (0.25f * (float)of));
}

BARRIER_INLINE float light_at(__local const float* w, const float x, const float y) {
  return w[0] + w[1] * x + w[2] * y + w[3] * (x * x - y * y) + w[4] * 2.0f * x * y;
}

// What of a line inside the rim is brighter than outside.
BARRIER_INLINE float rise_of(__global const float* lines, const int i) {
  return fmax(fmax(LEVEL(lines, 0)[i], LEVEL(lines, 1)[i]), LEVEL(lines, 2)[i]) -
         LEVEL(lines, RIM_SAMPLES - 1)[i];
}

// Leaves only the deep lines that show the ball.
BARRIER_INLINE void drop_hidden_deep_lines(__global const float* lines, const int count,
                                           __constant const RimNumbers* n, __local float* values,
                                           __local float* deep, __local float* deep_x,
                                           __local float* deep_y, __local short* deep_line,
                                           __local Levels* levels) {
  const int item = (int)get_local_id(0), rises = (count + 1) / 2;
  for (int i = item; i < rises; i += GROUP) values[i] = rise_of(lines, 2 * i);
  const int rank = min((int)(n->rise_rank * (float)rises), rises - 1);
  const float least = n->nothing * ranked(values, rises, rank, &levels->scalar);
  if (item == 0) {
    int kept = 0;
    for (int i = 0; i < levels->deep; ++i) {
      if (!(rise_of(lines, deep_line[i]) > least)) continue;
      for (int m = 0; m < RIM_DEEP && kept < i; ++m) {
        deep[kept * RIM_DEEP + m] = deep[i * RIM_DEEP + m];
      }
      deep_x[kept] = deep_x[i];
      deep_y[kept] = deep_y[i];
      deep_line[kept++] = deep_line[i];
    }
    levels->deep = kept;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// Noise of one sample: of lines side by side, or of those some pixels apart.
BARRIER_INLINE float sample_noise(__global const float* outermost, const int count,
                                  __constant const RimNumbers* n, __local float* values,
                                  __local float* scalar) {
  float noise[3];
#pragma unroll 1
  for (int k = 0; k < 3; ++k) {
    const int apart = k == 0 ? 1 : k * n->noise_apart;
    const int steps = count > apart ? (count - apart + 1) / 2 : 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int i = (int)get_local_id(0); i < steps; i += GROUP) {
      values[i] = fabs(outermost[apart + 2 * i] - outermost[2 * i]);
    }
    noise[k] = n->noise_per_median / sqrt(2.0f) * ranked(values, steps, steps / 2, scalar);
  }
  const int alike = noise[1] > n->noise_alike * noise[0] && noise[2] < n->noise_even * noise[1];
  return alike ? noise[1] : noise[0];
}

// Counts the lines of each sector, which lie in the order of the sectors.
BARRIER_INLINE void count_sectors(__global const float* turn, __local const short* which,
                                  const int count, __local Levels* levels) {
  const int item = (int)get_local_id(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int b = item; b < RIM_LEVEL_SECTORS; b += GROUP) levels->count[b] = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = item; i < count; i += GROUP) {
    atomic_inc(&levels->count[sector_of(turn[which ? which[i] : i], RIM_LEVEL_SECTORS)]);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0) {
    levels->begin[0] = 0;
#pragma unroll 1
    for (int b = 0; b < RIM_LEVEL_SECTORS; ++b) {
      levels->begin[b + 1] = levels->begin[b] + levels->count[b];
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// The background's level by sector: the mean of what lies near the middle of its own median and the
// neighbours'.
BARRIER_INLINE void ground_levels(__global const float* lines, const int count,
                                  __constant const RimNumbers* n, __local float* values,
                                  __local Levels* levels) {
  const int item = (int)get_local_id(0);
  count_sectors(TURN(lines), 0, count, levels);
  for (int i = item; i < count; i += GROUP) values[i] = LEVEL(lines, RIM_SAMPLES - 1)[i];
  barrier(CLK_LOCAL_MEM_FENCE);
  const float window = n->ground_noise * levels->noise + n->ground_least;
  for (int b = item; b < RIM_LEVEL_SECTORS; b += GROUP) {
    levels->medians[b] = levels->count[b] == 0
                             ? 0.0f
                             : near_quantile(values + levels->begin[b], levels->count[b], 0.5f,
                                             n->ground_tolerance * window);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int b = item; b < RIM_LEVEL_SECTORS; b += GROUP) {
    float known[3] = {0.0f, 0.0f, 0.0f};
    int some = 0;
    for (int k = -1; k <= 1; ++k) {
      const int sector = (b + k + RIM_LEVEL_SECTORS) % RIM_LEVEL_SECTORS;
      if (levels->count[sector] > 0) known[some++] = levels->medians[sector];
    }
    float level = 0.0f;
    if (some > 0) {
      const float low = fmin(known[0], known[1]), high = fmax(known[0], known[1]);
      const float middle = some == 3   ? fmax(low, fmin(high, known[2]))
                           : some == 2 ? high
                                       : known[0];
      float sum = 0.0f, near = 0.0f;
      for (int k = -1; k <= 1; ++k) {
        const int sector = (b + k + RIM_LEVEL_SECTORS) % RIM_LEVEL_SECTORS;
        for (int i = levels->begin[sector]; i < levels->begin[sector + 1]; ++i) {
          const float off = values[i] - middle;
          if (fabs(off) < window) {
            sum += off;
            near += 1.0f;
          }
        }
      }
      level = middle + sum / fmax(near, 1.0f);
    }
    levels->ground[b] = level;
  }
  const float median =
      ranked(levels->ground, RIM_LEVEL_SECTORS, RIM_LEVEL_SECTORS / 2, &levels->scalar);
  if (item == 0) levels->ground_median = median;
  barrier(CLK_LOCAL_MEM_FENCE);
}

// Solves for the paint's coefficients, or where it settles for their corrections, from the sectors'
// weights and weighted levels.
BARRIER_INLINE void solve_light(__local Levels* levels, __constant const RimNumbers* n,
                                const int settles) {
  const int item = (int)get_local_id(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int k = item; k < TRIANGLE(5, 0) + 5; k += GROUP) {
    int row = 0;
    while (row < 4 && TRIANGLE(row + 1, 0) <= k) ++row;
    const int column = k - TRIANGLE(row, 0);
    const int right = k - TRIANGLE(5, 0);
    const float held = settles ? n->held : n->no_shading[(row + 1) / 2];
    float sum = right < 0 && row == column ? held : 0.0f;
    for (int b = 0; b < RIM_LEVEL_SECTORS; ++b) {
      sum += right < 0 ? levels->weight[b] * levels->basis[b][row] * levels->basis[b][column]
                       : levels->weighted[b] * levels->basis[b][right];
    }
    if (right < 0) {
      levels->normal[k] = sum;
    } else {
      levels->right[right] = sum;
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0) {
    cholesky(levels->normal, 5, 0.0f);
    cholesky_solve(levels->normal, 5, levels->right);
    for (int m = 0; m < 5; ++m) {
      levels->light[m] = levels->right[m] + (settles ? levels->light[m] : 0.0f);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// The paint's level through the upper crowd of the deep samples.
BARRIER_INLINE void fit_light(__global const float* lines, __constant const RimNumbers* n,
                              __local const float* deep, __local const float* deep_x,
                              __local const float* deep_y, __local const short* deep_line,
                              __local Levels* levels) {
  const int item = (int)get_local_id(0);
  count_sectors(TURN(lines), deep_line, levels->deep, levels);
  for (int b = item; b < RIM_LEVEL_SECTORS; b += GROUP) {
    const int begin = levels->begin[b], end = levels->begin[b + 1];
    const int middle = min((begin + end) / 2, max(levels->deep - 1, 0));
    const float x = deep_x[middle], y = deep_y[middle];
    levels->basis[b][0] = 1.0f;
    levels->basis[b][1] = x;
    levels->basis[b][2] = y;
    levels->basis[b][3] = x * x - y * y;
    levels->basis[b][4] = 2.0f * x * y;
    levels->medians[b] =
        begin == end ? 0.0f
                     : near_quantile(deep + begin * RIM_DEEP, (end - begin) * RIM_DEEP, n->bright,
                                     n->bright_noise * levels->noise + n->bright_least);
  }
  for (int m = item; m < 5; m += GROUP) levels->light[m] = 0.0f;
  barrier(CLK_LOCAL_MEM_FENCE);
  // First the upper envelope of the sectors; then it settles on what lies within a window about it
  // that shrinks to the noise.
  float contrast = 0.0f;
  for (int pass = 0; pass < n->envelope_passes + 3; ++pass) {
    const int settles = pass - n->envelope_passes;
    if (settles == 0) contrast = levels->light[0] - levels->ground_median;
    const float last = fmax(n->window_noise * levels->noise, n->window_least * contrast);
    const float first = settles == 0 ? n->window_first : settles == 1 ? n->window_next : 0.0f;
    const float window = fmax(first * contrast, last);
    for (int b = item; b < RIM_LEVEL_SECTORS; b += GROUP) {
      float weight = 0.0f, weighted = 0.0f;
      if (settles >= 0) {
        for (int i = levels->begin[b]; i < levels->begin[b + 1]; ++i) {
          const float light = light_at(levels->light, deep_x[i], deep_y[i]);
#pragma unroll 1
          for (int m = 0; m < RIM_DEEP; ++m) {
            const float off = deep[i * RIM_DEEP + m] - light;
            if (fabs(off) <= window) {
              weighted += off;
              weight += 1.0f;
            }
          }
        }
      } else if (levels->count[b] > 0) {
        float off = levels->medians[b];
        for (int m = 0; m < 5; ++m) off -= levels->light[m] * levels->basis[b][m];
        const int dark = pass > 0 && off <= -n->below * (levels->light[0] - levels->ground_median);
        weight = dark ? n->below_weight : 1.0f;
        weighted = weight * levels->medians[b];
      }
      levels->weight[b] = weight;
      levels->weighted[b] = weighted;
    }
    solve_light(levels, n, settles >= 0);
  }
}

// Returns 0 where too few lines show the ball: then they are none.
BARRIER_INLINE int find_levels(__global const float* lines, const int count,
                               __constant const RimNumbers* n, __local float* values,
                               __local float* deep, __local float* deep_x, __local float* deep_y,
                               __local short* deep_line, __local Levels* levels) {
  const int item = (int)get_local_id(0);
  drop_hidden_deep_lines(lines, count, n, values, deep, deep_x, deep_y, deep_line, levels);
  __global const float* outermost = LEVEL(lines, RIM_SAMPLES - 1);
  const float noise = sample_noise(outermost, count, n, values, &levels->scalar);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0) levels->noise = noise;
  barrier(CLK_LOCAL_MEM_FENCE);
  ground_levels(lines, count, n, values, levels);
  fit_light(lines, n, deep, deep_x, deep_y, deep_line, levels);
  if (item == 0) {
    levels->usual = fmax(levels->light[0] - levels->ground_median, n->least_contrast);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  return levels->deep >= n->least_deep;
}

#endif  // IMPACTDIC_KERNELS_RIM_LEVELS_H_
