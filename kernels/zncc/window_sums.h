// Sums of pixels and of squares over every displaced window, from which its norm follows (Lewis
// 1995): first down the columns.
#ifndef IMPACTDIC_KERNELS_WINDOW_SUMS_H_
#define IMPACTDIC_KERNELS_WINDOW_SUMS_H_

#include "kernels/lanes.h"
#include "kernels/zncc/zncc.h"

// pixels: columns x … of a search area; a row a lag, from first_row on of the plane.
INLINE void put_column_sums(const REAL* pixels, __local float* plane, const int x,
                            const int first_row) {
  REAL sum = (REAL)(0.0f), squares = (REAL)(0.0f);
  UNROLL
  for (int y = 0; y < AREA_PX; ++y) {
    sum += pixels[y];
    squares += pixels[y] * pixels[y];
    if (y >= WINDOW_PX) {
      sum -= pixels[y - WINDOW_PX];
      squares -= pixels[y - WINDOW_PX] * pixels[y - WINDOW_PX];
    }
    if (y >= WINDOW_PX - 1) PUT(plane, x, first_row + y - WINDOW_PX + 1, sum, squares);
  }
}

#endif  // IMPACTDIC_KERNELS_WINDOW_SUMS_H_
