// Correlation maps for the sizes that go through clFFT: the norm of every displaced window from
// exact sums (Lewis 1995), the ZNCC, its highest value.
#define MAP_SPACE __global
#include "kernels/config.h"
#include "kernels/zncc/zncc.h"

// Sums of pixels and of squares down the columns of every displaced window.
static inline void column_sums(__global const float* second, const int width, const int height,
                               const SearchPlace place, const float level, const int lane,
                               __global float2* sums) {
  for (int x = lane; x < AREA_PX; x += GROUP) {
    float sum = 0.0f, squares = 0.0f;
    for (int y = 0; y < AREA_PX; ++y) {
      const int px = add_sat(place.x0, x), py = add_sat(place.y0, y);
      const float in = clamped_pixel(second, width, height, px, py) - level;
      sum += in;
      squares += in * in;
      if (y >= WINDOW_PX) {
        const float out =
            clamped_pixel(second, width, height, px, add_sat(place.y0, y - WINDOW_PX)) - level;
        sum -= out;
        squares -= out * out;
      }
      if (y >= WINDOW_PX - 1) sums[(y - WINDOW_PX + 1) * AREA_PX + x] = (float2)(sum, squares);
    }
  }
}

// images: (slots, height, width); windows: from `start` on; levels: (count), see cut_windows;
// planes: (count, FFT_PX, FFT_PX), the numerators in their real parts; sums: (count, LAGS, AREA_PX)
// scratch; maps: (count, LAGS, LAGS) written; weights: of the peaks; peaks: `count` written from
// `first_peak` on. One group a window.
__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void zncc_map(
    __global const float* images, const int width, const int height, __global const Window* windows,
    const uint start, __global const float2* levels, __global const float2* planes,
    __global float2* sums, __global float* maps, const float min_contrast,
    __global const float* weights, __global CorrelationPeak* peaks, const uint first_peak) {
  __local float values[GROUP];
  __local int indices[GROUP];
  __local float8 lines[PEAK_PATCH_PX];
  const int lane = (int)get_local_id(0);
  const size_t at = get_group_id(0);
  const Window window = windows[start + at];
  const SearchPlace place = search_place(window, width, height);
  const float level = levels[at].x, energy = levels[at].y;
  __global const float2* plane = planes + at * (FFT_PX * FFT_PX);
  __global float* map = maps + at * (LAGS * LAGS);
  sums += at * (LAGS * AREA_PX);
  column_sums(images + (size_t)width * (size_t)height * (size_t)window.second, width, height, place,
              level, lane, sums);
  barrier(CLK_GLOBAL_MEM_FENCE);

  const float scale = energy > 0.0f ? rsqrt(energy) : 0.0f;
  const float min_energy = min_contrast * min_contrast * WINDOW_PIXELS;
  for (int j = lane; j < LAGS; j += GROUP) {
    float2 sum = (float2)(0.0f, 0.0f);
    for (int x = 0; x < AREA_PX; ++x) {
      sum += sums[j * AREA_PX + x];
      if (x >= WINDOW_PX) sum -= sums[j * AREA_PX + x - WINDOW_PX];
      const int i = x - WINDOW_PX + 1;
      if (i >= 0) {
        map[j * LAGS + i] =
            plane[j * FFT_PX + i].x * scale * inverse_norm(sum.x, sum.y, min_energy);
      }
    }
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  write_peak(map, window, place, sqrt(energy * (1.0f / WINDOW_PIXELS)), min_contrast, weights,
             values, indices, lines, lane, GROUP, peaks + first_peak + at);
}
