// What the kernels of the zero-mean normalised cross-correlation share: where a window is looked
// for, its pixels, and the highest value of its correlation map.
//
// The map holds LAGS × LAGS values, row by row; entry (i, j) is the displacement
// (guess_u − SEARCH_PX + i, guess_v − SEARCH_PX + j).
#ifndef IMPACTDIC_KERNELS_ZNCC_H_
#define IMPACTDIC_KERNELS_ZNCC_H_

#include "kernels/config.h"
#include "kernels/status.h"
#include "kernels/types.h"

#define LAGS (2 * SEARCH_PX + 1)
#define AREA_PX (WINDOW_PX + 2 * SEARCH_PX)
#define WINDOW_PIXELS (WINDOW_PX * WINDOW_PX)

// The type of the pictures' pixels.
#ifndef PICTURE
#define PICTURE float
#endif

// Where the map lives: __local in the fused kernel, __global behind clFFT.
#ifndef MAP_SPACE
#define MAP_SPACE __local
#endif

// First pixel (x0, y0) of the search area, and the lags at which the displaced window lies wholly
// in the picture. Coordinates saturate, so that absurd guesses are out of view, not overflows.
typedef struct SearchPlace {
  int x0, y0;
  int min_x, max_x, min_y, max_y;
  int in_view;
} SearchPlace;

static inline SearchPlace search_place(const Window window, const int width, const int height) {
  SearchPlace place;
  place.x0 = sub_sat(add_sat(window.x0, window.guess_u), SEARCH_PX);
  place.y0 = sub_sat(add_sat(window.y0, window.guess_v), SEARCH_PX);
  place.min_x = place.x0 < 0 ? sub_sat(0, place.x0) : 0;
  place.min_y = place.y0 < 0 ? sub_sat(0, place.y0) : 0;
  place.max_x = min(LAGS - 1, sub_sat(width - WINDOW_PX, place.x0));
  place.max_y = min(LAGS - 1, sub_sat(height - WINDOW_PX, place.y0));
  const int template_in_view = window.x0 >= 0 && window.y0 >= 0 && window.x0 <= width - WINDOW_PX &&
                               window.y0 <= height - WINDOW_PX;
  place.in_view = template_in_view && place.min_x <= place.max_x && place.min_y <= place.max_y;
  return place;
}

// Pixel (x, y) of a picture, that of the nearest edge where it lies outside.
static inline float clamped_pixel(__global const PICTURE* image, const int width, const int height,
                                  const int x, const int y) {
  return (float)image[clamp(y, 0, height - 1) * width + clamp(x, 0, width - 1)];
}

// Weights of cubic convolution (Keys 1981, a = −1/2) at the fraction t between the second and the
// third of four samples.
static inline float4 cubic_weights(const float t) {
  const float4 c3 = (float4)(-0.5f, 1.5f, -1.5f, 0.5f);
  const float4 c2 = (float4)(1.0f, -2.5f, 2.0f, -0.5f);
  const float4 c1 = (float4)(-0.5f, 0.0f, 0.5f, 0.0f);
  const float4 c0 = (float4)(0.0f, 1.0f, 0.0f, 0.0f);
  return ((c3 * t + c2) * t + c1) * t + c0;
}

static inline float cubic_pixel(__global const PICTURE* image, const int width, const int height,
                                const float x, const float y) {
  const int ix = (int)floor(x), iy = (int)floor(y);
  const float4 wx = cubic_weights(x - (float)ix), wy = cubic_weights(y - (float)iy);
  float4 column;
  float rows[4];
  for (int j = 0; j < 4; ++j) {
    column.x = clamped_pixel(image, width, height, ix - 1, iy - 1 + j);
    column.y = clamped_pixel(image, width, height, ix, iy - 1 + j);
    column.z = clamped_pixel(image, width, height, ix + 1, iy - 1 + j);
    column.w = clamped_pixel(image, width, height, ix + 2, iy - 1 + j);
    rows[j] = dot(column, wx);
  }
  return dot((float4)(rows[0], rows[1], rows[2], rows[3]), wy);
}

// Pixel (i, j) of the template as it is expected in the second frame: the window itself, or, where
// a rotation is guessed, what stands there once the first frame is turned about the window's
// centre. Counter-clockwise on the screen takes (1, 0) to (cos, −sin), y being down.
static inline float template_pixel(__global const PICTURE* image, const int width, const int height,
                                   const Window window, const float2 cos_sin, const int i,
                                   const int j) {
  if (window.guess_rot_rad == 0.0f) {
    return clamped_pixel(image, width, height, window.x0 + i, window.y0 + j);
  }
  const float half_px = 0.5f * (float)(WINDOW_PX - 1);
  const float dx = (float)i - half_px, dy = (float)j - half_px;
  const float x = (float)window.x0 + half_px + dx * cos_sin.x - dy * cos_sin.y;
  const float y = (float)window.y0 + half_px + dx * cos_sin.y + dy * cos_sin.x;
  return cubic_pixel(image, width, height, x, y);
}

static inline float2 guessed_turn(const Window window) {
  return window.guess_rot_rad == 0.0f
             ? (float2)(1.0f, 0.0f)
             : (float2)(cos(window.guess_rot_rad), sin(window.guess_rot_rad));
}

// 1/√Σ(g − ḡ)² of a displaced window from the sums of its (shifted) pixels and squares; 0, which
// makes the correlation 0, where its contrast is below a tenth of what a template needs.
static inline float inverse_norm(const float sum, const float squares, const float min_energy) {
  const float energy = squares - sum * sum * (1.0f / WINDOW_PIXELS);
  return energy > 0.01f * min_energy && energy > 0.0f ? rsqrt(energy) : 0.0f;
}

// Larger value, and of equal ones the earlier in the map: the same on every device.
static inline int is_better(const float value, const int index, const float than_value,
                            const int than_index) {
  return value > than_value || (value == than_value && index < than_index);
}

// Highest of the work-items' candidates, for work-item 0 only. Passes two barriers.
static inline int best_of_lanes(__local float* values, __local int* indices, const int lane,
                                const int lanes, const float value, const int index) {
  values[lane] = value;
  indices[lane] = index;
  barrier(CLK_LOCAL_MEM_FENCE);
  int best = 0;
  for (int k = 1; k < lanes; ++k) {
    if (is_better(values[k], indices[k], values[best], indices[best])) best = k;
  }
  const int best_index = indices[best];
  barrier(CLK_LOCAL_MEM_FENCE);
  return best_index;
}

// Sum over the group's work-items, for all of them. Passes two barriers.
static inline float sum_of_group(__local float* values, const int lane, const float value) {
  values[lane] = value;
  barrier(CLK_LOCAL_MEM_FENCE);
  float sum = 0.0f;
  for (int k = 0; k < GROUP; ++k) sum += values[k];
  barrier(CLK_LOCAL_MEM_FENCE);
  return sum;
}

// Whether entry (i, j) is at least as high as its neighbours at valid lags.
static inline int is_local_maximum(MAP_SPACE const float* map, const SearchPlace place, const int i,
                                   const int j) {
  const int left = max(i - 1, place.min_x), right = min(i + 1, place.max_x);
  MAP_SPACE const float* above = map + max(j - 1, place.min_y) * LAGS;
  MAP_SPACE const float* row = map + j * LAGS;
  MAP_SPACE const float* below = map + min(j + 1, place.max_y) * LAGS;
  float most = fmax(row[left], row[right]);
  most = fmax(most, fmax(fmax(above[left], above[right]), above[i]));
  most = fmax(most, fmax(fmax(below[left], below[right]), below[i]));
  return row[i] >= most;
}

// The values about a peak through which its spline goes: as far as the lags do, on each side by
// itself; the peak is number (px, py) of the nx × ny from (x0, y0) on.
typedef struct Patch {
  int x0, y0, nx, ny, px, py;
} Patch;

static inline Patch patch_about(const SearchPlace place, const int x, const int y) {
  const int reach = PEAK_PATCH_PX / 2;
  Patch patch;
  patch.x0 = max(x - reach, place.min_x);
  patch.y0 = max(y - reach, place.min_y);
  patch.nx = min(x + reach, place.max_x) - patch.x0 + 1;
  patch.ny = min(y + reach, place.max_y) - patch.y0 + 1;
  patch.px = x - patch.x0;
  patch.py = y - patch.y0;
  return patch;
}

// Of CorrelationPeak's weights (types.h), those of n values with the peak at number p.
static inline __global const float* weights_of(__global const float* weights, const int n,
                                               const int p) {
  return weights + (n * PEAK_PATCH_PX + p) * PEAK_PATCH_PX * PEAK_WEIGHTS;
}

// Column x = 0 … PEAK_PATCH_PX − 1 of a patch to coefficients along y, into line x. Entries of the
// map are `stride` apart.
static inline void put_line(MAP_SPACE const float* map, const int stride, const Patch patch,
                            __global const float* weights, __local float8* lines, const int x) {
  __global const float8* down = (__global const float8*)weights_of(weights, patch.ny, patch.py);
  map += stride * min(patch.x0 + x, LAGS - 1);
  float8 line = 0.0f;
  // Values beyond the patch have no weight.
#pragma unroll
  for (int y = 0; y < PEAK_PATCH_PX; ++y) {
    line += down[y] * map[stride * LAGS * min(patch.y0 + y, LAGS - 1)];
  }
  lines[x] = line;
}

// Parts of a peak's coefficients that can be written one by one: a column's upper or lower half.
#define PEAK_PARTS (2 * PEAK_NEAR)

static inline void write_part(__local const float8* lines, const Patch patch,
                              __global const float* weights, const int part,
                              __global CorrelationPeak* peak) {
  const int i = part % PEAK_NEAR, lower = part / PEAK_NEAR;
  __global const float* across = weights_of(weights, patch.nx, patch.px) + i;
  float4 sum = 0.0f;
#pragma unroll
  for (int x = 0; x < PEAK_PATCH_PX; ++x) {
    sum += across[x * PEAK_WEIGHTS] * ((__local const float4*)lines)[2 * x + lower];
  }
  __global float* column = peak->coefficients + lower * 4 * PEAK_NEAR + i;
  column[0 * PEAK_NEAR] = sum.x;
  column[1 * PEAK_NEAR] = sum.y;
  column[2 * PEAK_NEAR] = sum.z;
  if (lower == 0) column[3 * PEAK_NEAR] = sum.w;
}

// Where a parabola through three samples about the highest has its peak, −1/2 … 1/2.
static inline float parabola_peak(const float before, const float at, const float after) {
  const float bend = before - 2.0f * at + after;
  return bend < 0.0f ? 0.5f * (before - after) / bend : 0.0f;
}

// All but the coefficients. (x, y): the highest entry of the map; second: the highest other peak.
// contrast: rms of the template about its mean, and its lower bound, in the pictures' grey levels.
static inline void write_head(MAP_SPACE const float* map, const int stride, const Window window,
                              const SearchPlace place, const int x, const int y, const float second,
                              const float contrast, const float min_contrast,
                              __global CorrelationPeak* peak) {
  const int has_texture = contrast >= min_contrast;
  const int on_edge = x == place.min_x || x == place.max_x || y == place.min_y || y == place.max_y;
  peak->status = !place.in_view ? STATUS_OUT_OF_VIEW
                 : !has_texture ? STATUS_NO_TEXTURE
                 : on_edge      ? STATUS_AT_SEARCH_EDGE
                                : STATUS_OK;
  peak->shift_x = window.guess_u - SEARCH_PX + x;
  peak->shift_y = window.guess_v - SEARCH_PX + y;
  const int has_peak = place.in_view && has_texture;
  MAP_SPACE const float* highest = map + stride * (y * LAGS + x);
  peak->value = has_peak ? *highest : NAN;
  peak->second = second;
  if (!has_peak || on_edge) return;
  peak->start_x = parabola_peak(highest[-stride], highest[0], highest[stride]);
  peak->start_y = parabola_peak(highest[-stride * LAGS], highest[0], highest[stride * LAGS]);
}

// Finds the highest and the second peak of the map and writes them with the spline about the
// highest. All `lanes` work-items of the group call it together; lines: PEAK_PATCH_PX.
static inline void write_peak(MAP_SPACE const float* map, const Window window,
                              const SearchPlace place, const float contrast,
                              const float min_contrast, __global const float* weights,
                              __local float* values, __local int* indices, __local float8* lines,
                              const int lane, const int lanes, __global CorrelationPeak* peak) {
  const int columns = place.in_view ? place.max_x - place.min_x + 1 : 0;
  const int entries = place.in_view ? columns * (place.max_y - place.min_y + 1) : 0;
  float value = -2.0f;
  int index = LAGS * LAGS;
  for (int k = lane; k < entries; k += lanes) {
    const int at = (place.min_y + k / columns) * LAGS + place.min_x + k % columns;
    if (is_better(map[at], at, value, index)) {
      value = map[at];
      index = at;
    }
  }
  const int best = best_of_lanes(values, indices, lane, lanes, value, index);
  const int best_x = best % LAGS, best_y = best / LAGS;
  value = -2.0f;
  index = LAGS * LAGS;
  for (int k = lane; k < entries; k += lanes) {
    const int i = place.min_x + k % columns, j = place.min_y + k / columns;
    const int at = j * LAGS + i;
    const int is_far = abs(i - best_x) > 2 || abs(j - best_y) > 2;
    if (is_far && is_better(map[at], at, value, index) && is_local_maximum(map, place, i, j)) {
      value = map[at];
      index = at;
    }
  }
  const int second = best_of_lanes(values, indices, lane, lanes, value, index);
  const Patch patch = patch_about(place, best_x, best_y);
  if (place.in_view) {
    for (int x = lane; x < PEAK_PATCH_PX; x += lanes) put_line(map, 1, patch, weights, lines, x);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) {
    write_head(map, 1, window, place, best_x, best_y, second < LAGS * LAGS ? map[second] : -2.0f,
               contrast, min_contrast, peak);
  }
  if (!place.in_view) return;
  for (int part = lane; part < PEAK_PARTS; part += lanes) {
    write_part(lines, patch, weights, part, peak);
  }
}

#endif  // IMPACTDIC_KERNELS_ZNCC_H_
