#include "kernels/config.h"
#include "kernels/types.h"

// How a sphere has turned between two pictures, however far: both are shrunk to small maps of what
// is lighter or darker than about it, and the maps are correlated over turns of SO(3).

// Cells beyond these see the surface too much from the side.
#define MAP_RIM 0.95f        /* of the radius, in the first picture */
#define MAP_LEAST_DEPTH 0.3f /* of the radius, in the second one */
#define MAP_SURROUND 2       /* cells about a cell that it is compared with */
#define MAP_LEAST_OVERLAP 0.12f

// maps: (2, side, side) cells over the squares about the ball in both pictures, each the mean grey
// level less that of its surroundings over their deviation; 0 outside the ball or the picture.
// images: (slots, height, width). One work-item a cell: (side, side, 2).
__kernel void shrink_ball(__global const float* images, const int width, const int height,
                          const SphereSearchTask task, const float least_contrast,
                          __global float* maps) {
  const int i = (int)get_global_id(0), j = (int)get_global_id(1), which = (int)get_global_id(2);
  const int side = (int)get_global_size(0);
  const float cx = which == 0 ? task.cx_first : task.cx_second;
  const float cy = which == 0 ? task.cy_first : task.cy_second;
  const float cell = 2.0f * task.radius / (float)side;
  const float x = cx + ((float)i + 0.5f) * cell - task.radius;
  const float y = cy + ((float)j + 0.5f) * cell - task.radius;
  __global const float* image =
      images + (size_t)(which == 0 ? task.first : task.second) * width * height;
  const float reach = ((float)MAP_SURROUND + 0.5f) * cell;
  const int x0 = max(0, (int)ceil(x - reach)), x1 = min(width - 1, (int)floor(x + reach));
  const int y0 = max(0, (int)ceil(y - reach)), y1 = min(height - 1, (int)floor(y + reach));
  float own = 0.0f, own_count = 0.0f, sum = 0.0f, squares = 0.0f, count = 0.0f;
  for (int py = y0; py <= y1; ++py) {
    for (int px = x0; px <= x1; ++px) {
      const float dx = (float)px - cx, dy = (float)py - cy;
      if (dx * dx + dy * dy > task.radius * task.radius) continue;
      const float g = image[(size_t)py * width + px];
      sum += g;
      squares += g * g;
      count += 1.0f;
      if (fabs((float)px - x) <= 0.5f * cell && fabs((float)py - y) <= 0.5f * cell) {
        own += g;
        own_count += 1.0f;
      }
    }
  }
  float value = 0.0f;
  if (own_count > 0.0f) {
    const float mean = sum / count, variance = fmax(squares / count - mean * mean, 0.0f);
    value = (own / own_count - mean) / sqrt(variance + least_contrast * least_contrast);
  }
  maps[((size_t)which * side + j) * side + i] = value;
}

// scores: ZNCC of the cells that both pictures see under each turn, times the root of their share,
// so that few cells that agree by chance do not win; −1 where there are too few. turns: quaternions
// w, x, y, z in the camera's axes (Y up). One work-item a turn.
__kernel void score_turns(__global const float* maps, const int side, const int count,
                          __global const float4* turns, __global float* scores) {
  const int item = (int)get_global_id(0);
  if (item >= count) return;
  const float4 q = turns[item];
  // The matrix in the picture's axes, y down.
  const float w = q.s0, x = q.s1, y = -q.s2, z = q.s3;
  const float m00 = 1.0f - 2.0f * (y * y + z * z), m11 = 1.0f - 2.0f * (x * x + z * z);
  const float m22 = 1.0f - 2.0f * (x * x + y * y);
  const float m01 = 2.0f * (x * y + w * z), m10 = 2.0f * (x * y - w * z);
  const float m02 = 2.0f * (x * z - w * y), m20 = 2.0f * (x * z + w * y);
  const float m12 = 2.0f * (y * z + w * x), m21 = 2.0f * (y * z - w * x);
  __global const float* second = maps + side * side;
  const float cell = 2.0f / (float)side;
  float n = 0.0f, f1 = 0.0f, g1 = 0.0f, ff = 0.0f, gg = 0.0f, fg = 0.0f;
  for (int j = 0; j < side; ++j) {
    const float py = ((float)j + 0.5f) * cell - 1.0f;
    for (int i = 0; i < side; ++i) {
      const float px = ((float)i + 0.5f) * cell - 1.0f;
      const float across = px * px + py * py;
      if (across > MAP_RIM * MAP_RIM) continue;
      const float pz = sqrt(1.0f - across);
      const float to_z = m20 * px + m21 * py + m22 * pz;
      if (to_z < MAP_LEAST_DEPTH) continue;
      const float to_x = m00 * px + m01 * py + m02 * pz, to_y = m10 * px + m11 * py + m12 * pz;
      const int u = clamp((int)((to_x + 1.0f) / cell), 0, side - 1);
      const int v = clamp((int)((to_y + 1.0f) / cell), 0, side - 1);
      const float weight = fmin(pz, to_z), f = maps[j * side + i], g = second[v * side + u];
      n += weight;
      f1 += weight * f;
      g1 += weight * g;
      ff += weight * f * f;
      gg += weight * g * g;
      fg += weight * f * g;
    }
  }
  // Of a sphere seen whole, Σ weight is 2/3 of the disc's cells.
  const float share = n / (2.0f / 3.0f * 0.7854f * (float)(side * side));
  float score = -1.0f;
  if (share > MAP_LEAST_OVERLAP) {
    const float cross = fg - f1 * g1 / n, own = ff - f1 * f1 / n, other = gg - g1 * g1 / n;
    score = cross / sqrt(fmax(own * other, 1e-12f)) * sqrt(fmin(share, 1.0f));
  }
  scores[item] = score;
}
