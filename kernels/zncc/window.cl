// Interrogation windows for the sizes that go through clFFT: template and search area, mean-free,
// as the real and the imaginary part of one zero-padded picture (see single.cl).
#include "kernels/config.h"
#include "kernels/zncc/zncc.h"

// images: (slots, height, width); windows: from `start` on; planes: (count, FFT_PX, FFT_PX) written
// whole; levels: (count) written, x the level subtracted from the search area, y the template's
// energy Σ(t − t̄)². One group a window.
__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void cut_windows(
    __global const float* images, const int width, const int height, __global const Window* windows,
    const uint start, __global float2* planes, __global float2* levels) {
  __local float values[GROUP];
  const int lane = (int)get_local_id(0);
  const size_t at = get_group_id(0);
  const Window window = windows[start + at];
  const SearchPlace place = search_place(window, width, height);
  const float2 cos_sin = guessed_turn(window);
  const size_t frame = (size_t)width * (size_t)height;
  __global const float* first = images + frame * (size_t)window.first;
  __global const float* second = images + frame * (size_t)window.second;
  __global float2* plane = planes + at * (FFT_PX * FFT_PX);

  float template_sum = 0.0f, area_sum = 0.0f;
  for (int y = 0; y < FFT_PX; ++y) {
    for (int x = lane; x < FFT_PX; x += GROUP) {
      float2 pixel = (float2)(0.0f, 0.0f);
      if (x < WINDOW_PX && y < WINDOW_PX) {
        pixel.x = template_pixel(first, width, height, window, cos_sin, x, y);
      }
      if (x < AREA_PX && y < AREA_PX) {
        pixel.y = clamped_pixel(second, width, height, add_sat(place.x0, x), add_sat(place.y0, y));
      }
      template_sum += pixel.x;
      area_sum += pixel.y;
      plane[y * FFT_PX + x] = pixel;
    }
  }
  const float template_mean = sum_of_group(values, lane, template_sum) * (1.0f / WINDOW_PIXELS);
  const float level = sum_of_group(values, lane, area_sum) * (1.0f / (AREA_PX * AREA_PX));

  // Each work-item comes back to the pixels that it has written.
  float energy = 0.0f;
  for (int y = 0; y < AREA_PX; ++y) {
    for (int x = lane; x < AREA_PX; x += GROUP) {
      float2 pixel = plane[y * FFT_PX + x];
      if (x < WINDOW_PX && y < WINDOW_PX) {
        pixel.x -= template_mean;
        energy += pixel.x * pixel.x;
      }
      pixel.y -= level;
      plane[y * FFT_PX + x] = pixel;
    }
  }
  energy = sum_of_group(values, lane, energy);
  if (lane == 0) levels[at] = (float2)(level, energy);
}
