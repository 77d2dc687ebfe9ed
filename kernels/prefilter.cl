#include "kernels/config.h"
#include "kernels/spline.h"

// B-spline coefficients of whole pictures: the recursive filter of Unser, Aldroubi and Eden (1993)
// written as its impulse response, cut where the rest is below 1e-8 of a pixel, so that every
// pixel is independent of the others; a Gaussian that smooths the picture beforehand is part of
// the same taps. Beyond the border the picture is mirrored about its last pixel, and so are the
// coefficients in the pad.
// taps: (radius + 1) weights of distance 0 … radius. slots: (batch) which pictures.

static inline int mirrored(const int i, const int size) {
  if (size == 1) return 0;
  const int period = 2 * (size - 1);
  const int folded = abs(i) % period;
  return folded < size ? folded : period - folded;
}

// Along x. images: (slots, height, width); rows: (batch, height, pitch), pitch >= width +
// 2·SPLINE_PAD a multiple of VECTOR. One work-item for VECTOR neighbours: (pitch / VECTOR or more,
// height, batch).
__kernel void prefilter_rows(__global const float* images, __global float* rows,
                             __constant float* taps, const int radius, __global const int* slots,
                             const int width, const int height, const int pitch) {
  const int column = (int)get_global_id(0) * VECTOR;
  if (column >= pitch) return;
  const size_t y = get_global_id(1), batch = get_global_id(2);
  const int x = column - SPLINE_PAD;
  __global const float* line = images + ((size_t)slots[batch] * height + y) * width;
  REAL sum;
  if (x >= radius && x + VECTOR + radius <= width) {
    sum = taps[0] * LOAD_REAL(line + x);
    for (int k = 1; k <= radius; ++k) {
      sum += taps[k] * (LOAD_REAL(line + x - k) + LOAD_REAL(line + x + k));
    }
  } else {
    float lanes[VECTOR];
    for (int lane = 0; lane < VECTOR; ++lane) {
      float one = taps[0] * line[mirrored(x + lane, width)];
      for (int k = 1; k <= radius; ++k) {
        one +=
            taps[k] * (line[mirrored(x + lane - k, width)] + line[mirrored(x + lane + k, width)]);
      }
      lanes[lane] = one;
    }
    sum = LOAD_REAL(lanes);
  }
  STORE_REAL(sum, rows + (batch * height + y) * pitch + column);
}

// Along y. coefficients: from element `offset` on (slots, height + 2·SPLINE_PAD, pitch); pixel (x,
// y) of the picture stands at (x + SPLINE_PAD, y + SPLINE_PAD). One work-item for VECTOR
// neighbours: (pitch / VECTOR or more, height + 2·SPLINE_PAD, batch).
__kernel void prefilter_columns(__global const float* rows, __global float* coefficients,
                                __constant float* taps, const int radius, __global const int* slots,
                                const int height, const int pitch, const int offset) {
  const int column = (int)get_global_id(0) * VECTOR;
  if (column >= pitch) return;
  const size_t batch = get_global_id(2);
  const int y = (int)get_global_id(1) - SPLINE_PAD;
  __global const float* from = rows + batch * height * pitch + column;
  REAL sum;
  if (y >= radius && y + radius < height) {
    __global const float* above = from + (size_t)y * pitch;
    __global const float* below = above;
    sum = taps[0] * LOAD_REAL(above);
    for (int k = 1; k <= radius; ++k) {
      above -= pitch;
      below += pitch;
      sum += taps[k] * (LOAD_REAL(above) + LOAD_REAL(below));
    }
  } else {
    sum = taps[0] * LOAD_REAL(from + (size_t)mirrored(y, height) * pitch);
    for (int k = 1; k <= radius; ++k) {
      sum += taps[k] * (LOAD_REAL(from + (size_t)mirrored(y - k, height) * pitch) +
                        LOAD_REAL(from + (size_t)mirrored(y + k, height) * pitch));
    }
  }
  const size_t row = (size_t)slots[batch] * (height + 2 * SPLINE_PAD) + get_global_id(1);
  STORE_REAL(sum, coefficients + offset + row * pitch + column);
}

// The spline and its slopes at the pixels. planes: (slots, 3, height, width_pitch): value, ∂/∂x,
// ∂/∂y; `coefficients` and `offset` as above, plane_pitch >= width a multiple of VECTOR. One
// work-item for VECTOR neighbours: (plane_pitch / VECTOR or more, height, batch).
__kernel void gradients(__global const float* coefficients, __global float* planes,
                        __global const int* slots, const int height, const int pitch,
                        const int plane_pitch, const int offset) {
  const int x = (int)get_global_id(0) * VECTOR;
  if (x >= plane_pitch) return;
  const size_t y = get_global_id(1), slot = (size_t)slots[get_global_id(2)];
  const int reach = (SPLINE_DEGREE - 1) / 2;
  __global const float* c = coefficients + offset +
                            (slot * (height + 2 * SPLINE_PAD) + y + SPLINE_PAD - reach) * pitch +
                            x + SPLINE_PAD - reach;
  REAL weights[SPLINE_MAX_TAPS], slopes[SPLINE_MAX_TAPS];
  spline_weights(SPLINE_DEGREE, 0.0f, weights);
  spline_slopes(SPLINE_DEGREE, 0.0f, slopes);
  REAL value = 0.0f, along_x = 0.0f, along_y = 0.0f;
#pragma unroll
  for (int j = 0; j < SPLINE_DEGREE; ++j) {
    REAL row = 0.0f, row_slope = 0.0f;
#pragma unroll
    for (int i = 0; i < SPLINE_DEGREE; ++i) {
      const REAL tap = LOAD_REAL(c + j * pitch + i);
      row += weights[i] * tap;
      row_slope += slopes[i] * tap;
    }
    value += weights[j] * row;
    along_x += weights[j] * row_slope;
    along_y += slopes[j] * row;
  }
  const size_t plane = (size_t)height * plane_pitch;
  __global float* out = planes + slot * 3 * plane + y * plane_pitch + x;
  STORE_REAL(value, out);
  STORE_REAL(along_x, out + plane);
  STORE_REAL(along_y, out + 2 * plane);
}
