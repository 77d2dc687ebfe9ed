// What the kernels of equal windows share: where a window lies in its pictures, FFT_PX × FFT_PX each.
#ifndef IMPACTDIC_KERNELS_EQUAL_H_
#define IMPACTDIC_KERNELS_EQUAL_H_

#include "kernels/lanes.h"
#include "kernels/types.h"

#define PIXELS ((float)(FFT_PX * FFT_PX))
#define CROSS EQUAL_CROSS

typedef struct Place {
  int first, second;  // of the window's first pixel in the pictures
  int in_view;
} Place;

INLINE Place place_of(const Window window, const int width, const int height) {
  const int x1 = add_sat(window.x0, window.guess_u), y1 = add_sat(window.y0, window.guess_v);
  const int most_x = width - FFT_PX, most_y = height - FFT_PX;
  Place place;
  place.in_view = min(min(window.x0, window.y0), min(x1, y1)) >= 0 &&
                  max(window.x0, x1) <= most_x && max(window.y0, y1) <= most_y;
  place.first = place.in_view ? (window.first * height + window.y0) * width + window.x0 : 0;
  place.second = place.in_view ? (window.second * height + y1) * width + x1 : 0;
  return place;
}

#endif  // IMPACTDIC_KERNELS_EQUAL_H_
