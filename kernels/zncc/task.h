// A window, where it is looked for, and its pictures; its pixels a column a work-item.
#ifndef IMPACTDIC_KERNELS_TASK_H_
#define IMPACTDIC_KERNELS_TASK_H_

#define PICTURE PIXEL
#include "kernels/lanes.h"
#include "kernels/zncc/zncc.h"

typedef struct Task {
  Window window;
  SearchPlace place;
  __global const PIXEL* first;
  __global const PIXEL* second;
} Task;

INLINE Task task_of(__global const PIXEL* pixels, const int width, const int height,
                    const Window window) {
  const size_t frame = (size_t)width * (size_t)height;
  Task task;
  task.window = window;
  task.place = search_place(window, width, height);
  task.first = pixels + frame * (size_t)window.first;
  task.second = pixels + frame * (size_t)window.second;
  return task;
}

#if VECTOR == 1
// Column x of a template; anything from column WINDOW_PX on. own: WINDOW_PX floats of local memory,
// `pitch` apart, that no other work-item uses.
INLINE void get_template(const Task* task, const int width, const int height, __local float* own,
                         const int pitch, const int x, float* pixels) {
  if (task->window.guess_rot_rad == 0.0f) {
    __global const PIXEL* column =
        task->first + task->window.y0 * ROW + task->window.x0 + min(x, WINDOW_PX - 1);
    UNROLL
    for (int y = 0; y < WINDOW_PX; ++y) pixels[y] = (float)column[y * ROW];
    return;
  }
  // Rolled, and therefore not into registers.
  const float2 turn = guessed_turn(task->window);
#pragma unroll 1
  for (int y = 0; x < WINDOW_PX && y < WINDOW_PX; ++y) {
    own[y * pitch] = template_pixel(task->first, width, height, task->window, turn, x, y);
  }
  UNROLL
  for (int y = 0; y < WINDOW_PX; ++y) pixels[y] = x < WINDOW_PX ? own[y * pitch] : 0.0f;
}

// Pixel (x, y) of a search area; outside the picture that of the nearest edge.
INLINE float area_pixel(const Task* task, const int width, const int height, const int x,
                        const int y) {
  return clamped_pixel(task->second, width, height, task->place.x0 + x, task->place.y0 + y);
}

INLINE int is_area_inside(const Task* task, const int width, const int height) {
  return task->place.x0 >= 0 && task->place.y0 >= 0 && task->place.x0 <= width - FFT_PX &&
         task->place.y0 <= height - AREA_PX;
}

// Column x of a search area inside the picture.
INLINE void get_inner_area(const Task* task, const int width, const int x, float* pixels) {
  __global const PIXEL* column = task->second + task->place.y0 * ROW + task->place.x0 + x;
  UNROLL
  for (int y = 0; y < AREA_PX; ++y) pixels[y] = (float)column[y * ROW];
}

// Column x of any search area. own: AREA_PX floats of local memory as above.
INLINE void get_area(const Task* task, const int width, const int height, __local float* own,
                     const int pitch, const int x, float* pixels) {
  if (is_area_inside(task, width, height)) {
    get_inner_area(task, width, x, pixels);
    return;
  }
#pragma unroll 1
  for (int y = 0; y < AREA_PX; ++y) own[y * pitch] = area_pixel(task, width, height, x, y);
  UNROLL
  for (int y = 0; y < AREA_PX; ++y) pixels[y] = own[y * pitch];
}
#endif

#endif  // IMPACTDIC_KERNELS_TASK_H_
