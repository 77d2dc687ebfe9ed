#include "kernels/config.h"
#include "kernels/frames/prefilter.h"
#include "kernels/spline.h"

// B-spline coefficients of whole pictures: the recursive filter of Unser, Aldroubi and Eden (1993)
// written as its impulse response, cut where the rest is below 1e-8 of a pixel (RADIUS), so that
// every pixel is independent of the others; a Gaussian that smooths the picture beforehand is part
// of the same taps. Beyond the border the picture is mirrored about its last pixel, and so are the
// coefficients in the pad.
// taps: (RADIUS + 1) weights of distance 0 … RADIUS. slots: which pictures, from element `first` on
// (batch).

static inline int mirrored(const int i, const int size) {
  const int period = 2 * (size - 1);
  int folded = abs(i);
  if (folded > period) folded = size == 1 ? 0 : folded % period;  // far beyond: slow
  return min(folded, period - folded);
}

#if VECTOR == 1
#define ACROSS PREFILTER_ACROSS
#define REACH ((RADIUS + ACROSS - 1) / ACROSS * ACROSS)
#define SPAN (PREFILTER_ITEMS * ACROSS) /* columns of a group */

// Along x. images: (slots, height, width); rows: (batch, height, pitch), pitch >= width +
// 2·SPLINE_PAD a multiple of ACROSS. A work-item for ACROSS neighbours: (pitch / ACROSS or more,
// height or more, batch).
__kernel __attribute__((reqd_work_group_size(PREFILTER_ITEMS, PREFILTER_LINES, 1))) void
prefilter_rows(__global const float* images, __global float* rows, __constant float* taps,
               __global const int* slots, const int first, const int width, const int height,
               const int pitch) {
  __local float4 pixels[PREFILTER_LINES][(SPAN + 2 * REACH) / ACROSS];
  const int item = (int)get_local_id(0), line = (int)get_local_id(1);
  const int y = (int)get_global_id(1), batch = (int)get_global_id(2);
  const int x0 = (int)get_group_id(0) * SPAN - SPLINE_PAD - REACH;
  __global const float* from =
      images + ((size_t)slots[first + batch] * height + min(y, height - 1)) * width;
  for (int i = item; i < SPAN + 2 * REACH; i += PREFILTER_ITEMS) {
    ((__local float*)pixels[line])[i] = from[mirrored(x0 + i, width)];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  float sums[ACROSS] = {0.0f, 0.0f, 0.0f, 0.0f};
#pragma unroll
  for (int part = 0; part < 2 * REACH / ACROSS + 1; ++part) {
    const float4 four = pixels[line][item + part];
    const float own[ACROSS] = {four.x, four.y, four.z, four.w};
#pragma unroll
    for (int i = 0; i < ACROSS; ++i) {
#pragma unroll
      for (int k = 0; k < ACROSS; ++k) {
        const int distance = abs(part * ACROSS + i - REACH - k);
        if (distance <= RADIUS) sums[k] += taps[distance] * own[i];
      }
    }
  }
  const int column = (int)get_global_id(0) * ACROSS;
  if (y >= height || column >= pitch) return;
  __global float4* to = (__global float4*)(rows + ((size_t)batch * height + y) * pitch + column);
  *to = (float4)(sums[0], sums[1], sums[2], sums[3]);
}
#else
// Of a row, so many columns are laid out at once where its border is near: those beyond it are
// mirrored, which takes longer than what is done with them.
#define LAID_OUT (4 * VECTOR)

// line[from … from + count − 1], mirrored beyond the borders.
static inline void lay_out(__global const float* line, const int width, const int from,
                           const int count, float* out) {
  const int begin = clamp(-from, 0, count), end = clamp(width - from, begin, count);
  for (int i = 0; i < begin; ++i) out[i] = line[mirrored(from + i, width)];
  for (int i = begin; i < end; ++i) out[i] = line[from + i];
  for (int i = end; i < count; ++i) out[i] = line[mirrored(from + i, width)];
}

// Not vload: PoCL (3.1) makes that of halves, which its compiler does not always join again.
typedef REAL ANYWHERE __attribute__((aligned(4)));
#define FILTER_ROW(space, middle)                                                                  \
  REAL sum = taps[0] * *(space const ANYWHERE*)(middle);                                           \
  _Pragma("unroll") for (int k = 1; k <= RADIUS; ++k) {                                            \
    sum +=                                                                                         \
        taps[k] * (*(space const ANYWHERE*)((middle)-k) + *(space const ANYWHERE*)((middle) + k)); \
  }

// The same, one work-item for a row: (1, height, batch).
__kernel void prefilter_rows(__global const float* images, __global float* rows,
                             __constant float* taps, __global const int* slots, const int first,
                             const int width, const int height, const int pitch) {
  const size_t y = get_global_id(1), batch = get_global_id(2);
  __global const float* line = images + ((size_t)slots[first + batch] * height + y) * width;
  __global float* to = rows + (batch * height + y) * pitch;
  for (int begin = 0; begin < pitch; begin += LAID_OUT) {
    const int x = begin - SPLINE_PAD, end = min(begin + LAID_OUT, pitch);
    if (x >= RADIUS && x + LAID_OUT + RADIUS <= width) {
      for (int column = begin; column < end; column += VECTOR) {
        FILTER_ROW(__global, line + column - SPLINE_PAD)
        STORE_REAL(sum, to + column);
      }
    } else {
      float near[LAID_OUT + 2 * RADIUS];
      lay_out(line, width, x - RADIUS, LAID_OUT + 2 * RADIUS, near);
      for (int column = begin; column < end; column += VECTOR) {
        FILTER_ROW(__private, near + RADIUS + column - begin)
        STORE_REAL(sum, to + column);
      }
    }
  }
}
#endif

// The loop over mirrored rows: unrolled wholly it takes the compiler of a GPU longer than all else
// here, and runs no faster; on a CPU it cannot be unrolled, and the compiler says so.
#if VECTOR == 1
#define UNROLL_MIRRORED _Pragma("unroll 8")
#else
#define UNROLL_MIRRORED
#endif

// Adds the rows `at`, of j = −RADIUS …, to the sums of PREFILTER_DOWN rows.
#define FILTER_COLUMN(unroll, at)                                  \
  unroll for (int j = -RADIUS; j < RADIUS + PREFILTER_DOWN; ++j) { \
    const REAL pixel = LOAD_REAL(from + (size_t)(at)*pitch);       \
    _Pragma("unroll") for (int k = 0; k < PREFILTER_DOWN; ++k) {   \
      const int distance = abs(j - k);                             \
      if (distance <= RADIUS) sums[k] += taps[distance] * pixel;   \
    }                                                              \
  }

// Along y. coefficients: from element `offset` on (slots, height + 2·SPLINE_PAD, pitch); pixel (x,
// y) of the picture stands at (x + SPLINE_PAD, y + SPLINE_PAD). One work-item for VECTOR
// neighbours in PREFILTER_DOWN rows: (pitch / VECTOR or more, (height + 2·SPLINE_PAD) /
// PREFILTER_DOWN rounded up, batch).
__kernel void prefilter_columns(__global const float* rows, __global float* coefficients,
                                __constant float* taps, __global const int* slots, const int first,
                                const int height, const int pitch, const int offset) {
  const int column = (int)get_global_id(0) * VECTOR;
  if (column >= pitch) return;
  const int batch = (int)get_global_id(2);
  const int line = (int)get_global_id(1) * PREFILTER_DOWN, y = line - SPLINE_PAD;
  __global const float* from = rows + (size_t)batch * height * pitch + column;
  REAL sums[PREFILTER_DOWN];
#pragma unroll
  for (int k = 0; k < PREFILTER_DOWN; ++k) sums[k] = 0.0f;
  // Apart: finding a mirrored row takes longer than what is done with it.
  if (y >= RADIUS && y + PREFILTER_DOWN + RADIUS <= height) {
    FILTER_COLUMN(_Pragma("unroll"), y + j)
  } else {
    FILTER_COLUMN(UNROLL_MIRRORED, mirrored(y + j, height))
  }
  const int lines = height + 2 * SPLINE_PAD;
  __global float* to =
      coefficients + offset + ((size_t)slots[first + batch] * lines + line) * pitch + column;
#pragma unroll
  for (int k = 0; k < PREFILTER_DOWN; ++k) {
    if (line + k < lines) STORE_REAL(sums[k], to + (size_t)k * pitch);
  }
}

// The spline and its slopes at the pixels. planes: (slots, 3, height, width_pitch): value, ∂/∂x,
// ∂/∂y; `coefficients` and `offset` as above, plane_pitch >= width a multiple of VECTOR. One
// work-item for VECTOR neighbours in GRADIENT_DOWN rows: (plane_pitch / VECTOR or more, height /
// GRADIENT_DOWN rounded up, batch).
__kernel void gradients(__global const float* coefficients, __global float* planes,
                        __global const int* slots, const int first, const int height,
                        const int pitch, const int plane_pitch, const int offset) {
  const int x = (int)get_global_id(0) * VECTOR;
  if (x >= plane_pitch) return;
  const int y = (int)get_global_id(1) * GRADIENT_DOWN;
  const size_t slot = (size_t)slots[first + get_global_id(2)];
  const int reach = (SPLINE_DEGREE - 1) / 2;
  __global const float* c = coefficients + offset +
                            (slot * (height + 2 * SPLINE_PAD) + y + SPLINE_PAD - reach) * pitch +
                            x + SPLINE_PAD - reach;
  REAL weights[SPLINE_MAX_TAPS], slopes[SPLINE_MAX_TAPS];
  spline_weights(SPLINE_DEGREE, 0.0f, weights);
  spline_slopes(SPLINE_DEGREE, 0.0f, slopes);
  REAL value[GRADIENT_DOWN], along_x[GRADIENT_DOWN], along_y[GRADIENT_DOWN];
#pragma unroll
  for (int k = 0; k < GRADIENT_DOWN; ++k) value[k] = along_x[k] = along_y[k] = 0.0f;
#pragma unroll
  for (int j = 0; j < SPLINE_DEGREE + GRADIENT_DOWN - 1; ++j) {
    REAL row = 0.0f, row_slope = 0.0f;
#pragma unroll
    for (int i = 0; i < SPLINE_DEGREE; ++i) {
      const REAL tap = LOAD_REAL(c + j * pitch + i);
      row += weights[i] * tap;
      row_slope += slopes[i] * tap;
    }
#pragma unroll
    for (int k = 0; k < GRADIENT_DOWN; ++k) {
      if (j < k || j - k >= SPLINE_DEGREE) continue;
      value[k] += weights[j - k] * row;
      along_x[k] += weights[j - k] * row_slope;
      along_y[k] += slopes[j - k] * row;
    }
  }
  const size_t plane = (size_t)height * plane_pitch;
  __global float* out = planes + slot * 3 * plane + (size_t)y * plane_pitch + x;
#pragma unroll
  for (int k = 0; k < GRADIENT_DOWN; ++k) {
    if (y + k < height) {
      STORE_REAL(value[k], out);
      STORE_REAL(along_x[k], out + plane);
      STORE_REAL(along_y[k], out + 2 * plane);
    }
    out += plane_pitch;
  }
}
