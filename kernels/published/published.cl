// The dissertation's method (section 2.2): cross-correlation of two mean-free windows after bicubic
// spline interpolation with parts − 1 points between pixels, and the lag of its largest value.
//
// Interpolation and correlation are both linear, so that the correlation of the interpolated
// windows at one lag is c(l_x, l_y) = Σ f ∘ (A_{l_y} g A_{l_x}ᵀ), with a matrix A of WINDOW_PX² for
// each one-dimensional lag (host/dic/cubic_spline.h). It is evaluated at all whole-pixel lags, then
// at all fine lags within a pixel of the highest of them, moving on while the highest lies at the
// edge of that neighbourhood: the same lag as interpolating first, at a fraction of the work.
#include "kernels/config.h"
// Whole-pixel lags of equal windows.
#undef SEARCH_PX
#define SEARCH_PX (WINDOW_PX - 1)
#define MAP_SPACE __global
#include "kernels/motion.h"
#include "kernels/zncc/zncc.h"

#define MOST_MOVES 8
// Scratch of a window: f, g, A g, fᵀ A g, and the map at whole pixels.
#define SCRATCH (4 * WINDOW_PIXELS + LAGS * LAGS)

// Window less its mean, and the sum of its squares. Passes barriers.
static inline float cut_mean_free(__global const float* image, const int width, const int x0,
                                  const int y0, __global float* out, __local float* values,
                                  const int lane) {
  float sum = 0.0f;
  for (int k = lane; k < WINDOW_PIXELS; k += GROUP) {
    out[k] = image[(y0 + k / WINDOW_PX) * width + x0 + k % WINDOW_PX];
    sum += out[k];
  }
  const float mean = sum_of_group(values, lane, sum) * (1.0f / WINDOW_PIXELS);
  float squares = 0.0f;
  for (int k = lane; k < WINDOW_PIXELS; k += GROUP) {
    out[k] -= mean;
    squares += out[k] * out[k];
  }
  return sum_of_group(values, lane, squares);
}

// q = fᵀ A g. Passes barriers before and after.
static inline void project(__global const float* a, __global const float* f,
                           __global const float* g, __global float* ag, __global float* q,
                           const int lane) {
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int k = lane; k < WINDOW_PIXELS; k += GROUP) {
    const int row = k / WINDOW_PX * WINDOW_PX, column = k % WINDOW_PX;
    float sum = 0.0f;
    for (int i = 0; i < WINDOW_PX; ++i) sum += a[row + i] * g[i * WINDOW_PX + column];
    ag[k] = sum;
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int k = lane; k < WINDOW_PIXELS; k += GROUP) {
    const int row = k / WINDOW_PX, column = k % WINDOW_PX;
    float sum = 0.0f;
    for (int i = 0; i < WINDOW_PX; ++i) sum += f[i * WINDOW_PX + row] * ag[i * WINDOW_PX + column];
    q[k] = sum;
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
}

static inline float dot_of(__global const float* a, __global const float* q) {
  float sum = 0.0f;
  for (int k = 0; k < WINDOW_PIXELS; ++k) sum += a[k] * q[k];
  return sum;
}

static inline __global const float* lag_matrix(__global const float* matrices, const int reach,
                                               const int lag) {
  return matrices + (size_t)(lag + reach) * WINDOW_PIXELS;
}

// The highest correlation among the lags x0 … x1, y0 … y1 (each every `step`), in reading order the
// first of equals, as y · (2 reach + 1) + x with lags counted from −reach, the largest there is.
// Its value goes to *highest. Where `map` is given it gets the values, row by row.
static inline int highest_lag(__global const float* matrices, const int reach,
                              __global const float* f, __global const float* g, __global float* ag,
                              __global float* q, const int x0, const int x1, const int y0,
                              const int y1, const int step, __global float* map,
                              __local float* values, __local int* indices, const int lane,
                              float* highest) {
  const int columns = (x1 - x0) / step + 1;
  float value = -INFINITY;
  int index = INT_MAX;
  for (int y = y0; y <= y1; y += step) {
    project(lag_matrix(matrices, reach, y), f, g, ag, q, lane);
    for (int k = lane; k < columns; k += GROUP) {
      const int x = x0 + k * step;
      const float c = dot_of(lag_matrix(matrices, reach, x), q);
      const int at = (y + reach) * (2 * reach + 1) + x + reach;
      if (map) map[(y - y0) / step * columns + k] = c;
      if (is_better(c, at, value, index)) {
        value = c;
        index = at;
      }
    }
  }
  const int best = best_of_lanes(values, indices, lane, GROUP, value, index);
  values[lane] = value;
  indices[lane] = index;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int k = 0; k < GROUP; ++k) {
    if (indices[k] == best) *highest = values[k];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  return best;
}

// Second peak of the map at whole pixels over `highest`, which stands at `best` of it.
static inline float whole_pixel_ratio(__global const float* map, const int best,
                                      const float highest, __local float* values, const int lane) {
  SearchPlace place;
  place.min_x = place.min_y = 0;
  place.max_x = place.max_y = LAGS - 1;
  float value = -INFINITY;
  for (int k = lane; k < LAGS * LAGS; k += GROUP) {
    const int x = k % LAGS, y = k / LAGS;
    const int is_far = abs(x - best % LAGS) > 2 || abs(y - best / LAGS) > 2;
    if (is_far && map[k] > value && is_local_maximum(map, place, x, y)) value = map[k];
  }
  values[lane] = value;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int k = 0; k < GROUP; ++k) value = fmax(value, values[k]);
  barrier(CLK_LOCAL_MEM_FENCE);
  return highest / fmax(value, 1e-3f * highest);
}

// images: (slots, height, width); windows: from `start` on; matrices: (2 (WINDOW_PX − 1) parts + 1,
// WINDOW_PX, WINDOW_PX); scratch: (groups, SCRATCH); motions: written from `start` on. One group a
// window.
__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void published(
    __global const float* images, const int width, const int height, __global const Window* windows,
    const uint start, __global const float* matrices, const int parts, const float min_contrast,
    __global float* scratch, __global WindowMotion* motions) {
  __local float values[GROUP];
  __local int indices[GROUP];
  // Largest lag in interpolated points.
  const int reach = (WINDOW_PX - 1) * parts;
  const int lane = (int)get_local_id(0);
  const size_t at = start + get_group_id(0);
  const Window window = windows[at];
  const size_t frame = (size_t)width * (size_t)height;
  const int x1 = add_sat(window.x0, window.guess_u), y1 = add_sat(window.y0, window.guess_v);
  const int in_view = min(min(window.x0, window.y0), min(x1, y1)) >= 0 &&
                      max(window.x0, x1) <= width - WINDOW_PX &&
                      max(window.y0, y1) <= height - WINDOW_PX;
  // The whole group leaves together.
  if (!in_view) {
    if (lane == 0) motions[at] = no_motion(STATUS_OUT_OF_VIEW, NAN);
    return;
  }
  __global float* f = scratch + get_group_id(0) * SCRATCH;
  __global float* g = f + WINDOW_PIXELS;
  __global float* ag = g + WINDOW_PIXELS;
  __global float* q = ag + WINDOW_PIXELS;
  __global float* map = q + WINDOW_PIXELS;
  const float f_squares = cut_mean_free(images + frame * (size_t)window.first, width, window.x0,
                                        window.y0, f, values, lane);
  const float g_squares =
      cut_mean_free(images + frame * (size_t)window.second, width, x1, y1, g, values, lane);
  if (fmin(f_squares, g_squares) < min_contrast * min_contrast * WINDOW_PIXELS) {
    if (lane == 0) motions[at] = no_motion(STATUS_NO_TEXTURE, NAN);
    return;
  }

  float whole_value = 0.0f, value = 0.0f;
  const int whole = highest_lag(matrices, reach, f, g, ag, q, -reach, reach, -reach, reach, parts,
                                map, values, indices, lane, &whole_value);
  int x = whole % (2 * reach + 1) - reach, y = whole / (2 * reach + 1) - reach;
  const int whole_at = (y + reach) / parts * LAGS + (x + reach) / parts;
  int is_inside = 0;
  for (int move = 0; move < MOST_MOVES && !is_inside; ++move) {
    const int left = max(x - parts, -reach), right = min(x + parts, reach);
    const int top = max(y - parts, -reach), bottom = min(y + parts, reach);
    const int best = highest_lag(matrices, reach, f, g, ag, q, left, right, top, bottom, 1, 0,
                                 values, indices, lane, &value);
    x = best % (2 * reach + 1) - reach;
    y = best / (2 * reach + 1) - reach;
    is_inside = (x > left || left == -reach) && (x < right || right == reach) &&
                (y > top || top == -reach) && (y < bottom || bottom == reach);
  }
  // The interpolated windows' energies are their own correlations at lag 0.
  float energy = 1.0f;
  for (int which = 0; which < 2; ++which) {
    __global const float* own = which ? g : f;
    project(lag_matrix(matrices, reach, 0), own, own, ag, q, lane);
    energy *= sqrt(dot_of(lag_matrix(matrices, reach, 0), q));
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  const float ratio = whole_pixel_ratio(map, whole_at, whole_value, values, lane);
  if (lane > 0) return;
  WindowMotion motion;
  motion.u = (float)window.guess_u + (float)x / (float)parts;
  motion.v = (float)window.guess_v + (float)y / (float)parts;
  motion.u_sd = motion.v_sd = 1.0f / ((float)parts * sqrt(12.0f));
  motion.correlation = value / energy;
  motion.peak_ratio = ratio;
  motion.ux = motion.uy = motion.vx = motion.vy = 0.0f;
  motion.status = STATUS_OK;
  motions[at] = motion;
}
