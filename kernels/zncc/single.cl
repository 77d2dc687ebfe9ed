// Zero-mean normalised cross-correlation (Lewis 1995) of a window with a search area in one kernel,
// for transforms of FFT_PX = 16, 32 and 64: a column a work-item. single_vector.cl is the same for
// devices without many of them.
//
// Template t (zero-padded) and search area g, both mean-free, are the real and the imaginary part
// of one picture, so that one forward transform Z serves both (hats: spectra):
//   t^(k) = (Z(k) + Z*(−k))/2,  g^(k) = (Z(k) − Z*(−k))/2i,  Σ t(x) g(x + l) = F⁻¹[t^* g^](l).
// What comes back is real, so that half of the rows and half of the columns are enough: the real
// rows 0 and FFT_PX/2 packed as one complex row, two columns of the map as one complex column.
// FFT_PX ≥ WINDOW_PX + 2·SEARCH_PX keeps every lag free of wrap-around. What the numerator is
// divided by comes from exact sums over each displaced window: the work-items that have nothing to
// transform back work it out meanwhile.
#include "kernels/config.h"
#define MAP_SPACE __local
#include "kernels/fft.h"
#include "kernels/zncc/map_peaks.h"
#include "kernels/zncc/window_sums.h"

#define HALF_PX (FFT_PX / 2)
// Work-items that hold columns x and x + COLUMNS of the map; the last may have but one.
#define COLUMNS ((LAGS + 1) / 2)
// Of what the transforms leave over Σ t(x) g(x + l).
#define SCALE (4.0f * FFT_PX * FFT_PX)
// What comes back: LAGS rows of FFT_PX/2 pairs, and behind them the sums over displaced windows.
#define BACK_PITCH (HALF_PX + 1)
#define BACK_FLOATS (2 * LAGS * BACK_PITCH)
#define SUM_FLOATS (2 * LAGS * PITCH)
#define PLANE_FLOATS (2 * PLANE > BACK_FLOATS + SUM_FLOATS ? 2 * PLANE : BACK_FLOATS + SUM_FLOATS)
#define MAP_FLOATS (LAGS * LAGS > 2 * FFT_PX ? LAGS * LAGS : 2 * FFT_PX)

// Sum over the template's columns. Elements from WINDOW_PX on are zero.
INLINE float sum_of_columns(__local const float* values) {
  float4 sum = vload4(0, values);
  UNROLL
  for (int k = 1; k < (WINDOW_PX + 3) / 4; ++k) sum += vload4(k, values);
  return (sum.s0 + sum.s1) + (sum.s2 + sum.s3);
}

// Column x of both, mean-free and zero-padded, in fft_order; returns the template's energy in it.
INLINE float merge(const float* t, const float* g, const float mean, const int x, float* re,
                   float* im) {
  float energy = 0.0f;
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) {
    const int y = fft_order(p, FFT_PX);
    re[p] = y < WINDOW_PX && x < WINDOW_PX ? t[y] - mean : 0.0f;
    im[p] = y < AREA_PX ? g[y] - mean : 0.0f;
    if (y < WINDOW_PX) energy += re[p] * re[p];
  }
  return energy;
}

INLINE void put_column(const float* re, const float* im, __local float* plane, const int x) {
  UNROLL
  for (int k = 0; k < FFT_PX; ++k) PUT(plane, x, k, re[k], im[k]);
}

INLINE void get_row(float* re, float* im, __local const float* plane, const int y) {
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) GET(plane, fft_order(p, FFT_PX), y, re[p], im[p]);
}

INLINE void put_row(const float* re, const float* im, __local float* plane, const int y) {
  UNROLL
  for (int k = 0; k < FFT_PX; ++k) PUT(plane, k, y, re[k], im[k]);
}

// 4 t^* g^ at a frequency from Z(k) and Z(−k).
INLINE float2 product_of(const float k_re, const float k_im, const float m_re, const float m_im) {
  const float half_re = k_re * m_im + k_im * m_re;
  return (float2)(half_re + half_re, m_re * m_re + m_im * m_im - k_re * k_re - k_im * k_im);
}

// Row y of Z to that of the product, in fft_back_order; row −y is in the plane.
INLINE void multiply_row(float* re, float* im, __local const float* plane, const int y) {
  float2 row[FFT_PX];
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) {
    const int k = fft_back_order(p, FFT_PX), m = fft_order(p, FFT_PX);
    float m_re, m_im;
    GET(plane, m, (FFT_PX - y) % FFT_PX, m_re, m_im);
    row[p] = product_of(re[k], im[k], m_re, m_im);
  }
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) {
    re[p] = row[p].x;
    im[p] = row[p].y;
  }
}

// The product's rows 0 and FFT_PX/2 as one, into the column of the plane that is only there for the
// sake of banks: FFT_PX/2 work-items, from `first` = 0 on, work out two values each.
INLINE void put_packed_row(__local float* plane, const int first) {
  for (int k = first; k < FFT_PX; k += HALF_PX) {
    const int m = (FFT_PX - k) % FFT_PX;
    float2 at_k, at_m;
    GET(plane, k, 0, at_k.x, at_k.y);
    GET(plane, m, 0, at_m.x, at_m.y);
    const float2 low = product_of(at_k.x, at_k.y, at_m.x, at_m.y);
    GET(plane, k, HALF_PX, at_k.x, at_k.y);
    GET(plane, m, HALF_PX, at_m.x, at_m.y);
    const float2 high = product_of(at_k.x, at_k.y, at_m.x, at_m.y);
    PUT(plane, FFT_PX, k, low.x - high.y, low.y + high.x);
  }
}

INLINE void get_packed_row(float* re, float* im, __local const float* plane) {
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) {
    GET(plane, FFT_PX, fft_back_order(p, FFT_PX), re[p], im[p]);
  }
}

INLINE void put_row_back(const float* re, const float* im, __local float2* back, const int y) {
  UNROLL
  for (int x = 0; x < LAGS; ++x) back[x * BACK_PITCH + y] = (float2)(re[x], im[x]);
}

// Columns x and x + COLUMNS of the map from the rows that came back, in fft_back_order.
INLINE void get_columns(float* re, float* im, __local const float2* back, const int x) {
  __local const float2* column_a = back + x * BACK_PITCH;
  __local const float2* column_b = back + min(x + COLUMNS, LAGS - 1) * BACK_PITCH;
  re[0] = column_a[0].x;
  im[0] = column_b[0].x;
  re[1] = column_a[0].y;
  im[1] = column_b[0].y;
  UNROLL
  for (int k = 1; k < HALF_PX; ++k) {
    const int p = fft_order(FFT_PX - k, FFT_PX), m = fft_order(k, FFT_PX);
    const float2 a = column_a[k], b = column_b[k];
    re[p] = a.x - b.y;
    im[p] = a.y + b.x;
    re[m] = a.x + b.y;
    im[m] = b.x - a.y;
  }
}

// Sums of pixels and squares down the columns first, first + HALF_PX, … of every displaced window.
// Any constant `level` near the pixels' keeps the sums of squares exact enough.
INLINE void put_area_sums(const Task* task, const int width, const int height, const float level,
                          __local float* sums, const int first) {
#pragma unroll 1
  for (int x = first; x < AREA_PX; x += HALF_PX) {
    if (is_area_inside(task, width, height)) {
      float pixels[AREA_PX];
      get_inner_area(task, width, x, pixels);
      UNROLL
      for (int y = 0; y < AREA_PX; ++y) pixels[y] -= level;
      put_column_sums(pixels, sums, x, 0);
      continue;
    }
    float sum = 0.0f, squares = 0.0f;
#pragma unroll 1
    for (int y = 0; y < AREA_PX; ++y) {
      const float in = area_pixel(task, width, height, x, y) - level;
      sum += in;
      squares += in * in;
      if (y >= WINDOW_PX) {
        const float out = area_pixel(task, width, height, x, y - WINDOW_PX) - level;
        sum -= out;
        squares -= out * out;
      }
      if (y >= WINDOW_PX - 1) PUT(sums, x, y - WINDOW_PX + 1, sum, squares);
    }
  }
}

// NaN for the norm of windows out of the picture: put_correlation makes −2 of it.
INLINE void mark_out_of_view(__local float* map, const SearchPlace place, const int lane) {
  if (place.min_x == 0 && place.min_y == 0 && place.max_x == LAGS - 1 && place.max_y == LAGS - 1) {
    return;
  }
#pragma unroll 1
  for (int k = lane; k < LAGS * LAGS; k += LANES) {
    const int x = k % LAGS, y = k / LAGS;
    if (x < place.min_x || x > place.max_x || y < place.min_y || y > place.max_y) map[k] = NAN;
  }
}

// Sums along the rows of those, and the norms of every displaced window, into the map: a row a
// work-item, first = 0 … HALF_PX − 1, and of the rows beyond two entries a work-item.
#define NORMS 8 /* at a time */
INLINE void put_norms(__local const float2* sums, __local float* map, const float min_energy,
                      const float scale, const int first) {
  if (first < LAGS) {
    __local const float2* row = sums + first * PITCH;
    float2 sum = 0.0f;
    UNROLL
    for (int x = 0; x < WINDOW_PX; ++x) sum += row[x];
    UNROLL
    for (int begin = 0; begin < LAGS; begin += NORMS) {
      float norms[NORMS];
      UNROLL
      for (int i = 0; i < NORMS; ++i) {
        const int x = begin + i;
        if (x >= LAGS) continue;
        norms[i] = scale * inverse_norm(sum.x, sum.y, min_energy);
        if (x + 1 < LAGS) sum += row[x + WINDOW_PX] - row[x];
      }
      UNROLL
      for (int i = 0; i < NORMS; ++i) {
        if (begin + i < LAGS) map[first * LAGS + begin + i] = norms[i];
      }
    }
  }
#pragma unroll 1
  for (int k = first; k < (LAGS - HALF_PX) * COLUMNS; k += HALF_PX) {
    const int y = HALF_PX + k / COLUMNS, x = 2 * (k % COLUMNS);
    __local const float2* entry = sums + y * PITCH + x;
    float2 sum = 0.0f;
    UNROLL
    for (int i = 0; i < WINDOW_PX; ++i) sum += entry[i];
    map[y * LAGS + x] = scale * inverse_norm(sum.x, sum.y, min_energy);
    if (x + 1 == LAGS) continue;
    sum += entry[WINDOW_PX] - entry[0];
    map[y * LAGS + x + 1] = scale * inverse_norm(sum.x, sum.y, min_energy);
  }
}

// The numerators in columns x and x + COLUMNS times the norms: the map, −2 out of view, and the
// highest value of each column and of them all, in_order.
INLINE void put_correlation(const float* a, const float* b, __local float* map,
                            __local int* highest, __local Found* found, const int x) {
  const int other = x + COLUMNS, has_both = other < LAGS;
  __local float* column_a = map + x;
  __local float* column_b = map + (has_both ? other : x);
  float at_a[LAGS], at_b[LAGS], highest_a = -2.0f, highest_b = -2.0f;
  UNROLL
  for (int y = 0; y < LAGS; ++y) {
    at_a[y] = fmax(a[y] * column_a[y * LAGS], -2.0f);
    at_b[y] = fmax(b[y] * column_b[y * LAGS], -2.0f);
    highest_a = fmax(highest_a, at_a[y]);
    highest_b = fmax(highest_b, at_b[y]);
  }
  UNROLL
  for (int y = 0; y < LAGS; ++y) {
    const float value = has_both ? at_b[y] : at_a[y];
    column_b[y * LAGS] = value;
    column_a[y * LAGS] = at_a[y];
  }
  if (!has_both) highest_b = -2.0f;
  highest[x] = in_order(highest_a);
  if (has_both) highest[other] = in_order(highest_b);
  atomic_max(&found[0].most, in_order(fmax(highest_a, highest_b)));
}

// pixels: (slots, height, width); windows: from `start` on; weights: of the
// peaks (types.h); peaks: (count) written. min_contrast: grey levels rms. One group of LANES =
// FFT_PX a window.
__kernel GROUP_SIZE void zncc_single(__global const PIXEL* pixels, const int width,
                                     const int height, __global const Window* windows,
                                     const uint start, const float min_contrast,
                                     __global const float* weights,
                                     __global CorrelationPeak* peaks) {
  __local float plane[PLANE_FLOATS] __attribute__((aligned(32)));
  __local float2* back = (__local float2*)plane;
  __local float* sums = plane + BACK_FLOATS;
  __local float8* lines = (__local float8*)plane;  // in the end
  __local float map[MAP_FLOATS] __attribute__((aligned(16)));
  __local float* totals = map;  // of the template's columns, before there are norms
  __local float* energies = map + FFT_PX;
  __local int highest[LAGS];  // of each column, in_order
  __local Found found[1];
  const int lane = (int)get_local_id(0);
  __global CorrelationPeak* peak = peaks + get_group_id(0);
  const Task task = task_of(pixels, width, height, windows[start + get_group_id(0)]);
  if (!task.place.in_view) {
    if (lane == 0) {
      peak->status = STATUS_OUT_OF_VIEW;
      peak->value = NAN;
    }
    return;
  }
  clear_found(found, 1, lane);

  const int is_low = lane < HALF_PX;
  float re[FFT_PX], im[FFT_PX], t[WINDOW_PX], g[AREA_PX], total = 0.0f;
  get_template(&task, width, height, plane + lane, PITCH, lane, t);
  get_area(&task, width, height, plane + lane, PITCH, lane, g);
  UNROLL
  for (int y = 0; y < WINDOW_PX; ++y) total += t[y];
  totals[lane] = lane < WINDOW_PX ? total : 0.0f;
  GROUP_BARRIER;
  const float mean = sum_of_columns(totals) * (1.0f / WINDOW_PIXELS);
  energies[lane] = merge(t, g, mean, lane, re, im);
  fft_forward(re, im, FFT_PX);
  put_column(re, im, plane, lane);
  GROUP_BARRIER;
  const float energy = sum_of_columns(energies);
  get_row(re, im, plane, lane);
  fft_forward(re, im, FFT_PX);
  // The other rows stay with who has them.
  if (lane == 0 || !is_low) put_row(re, im, plane, lane);
  GROUP_BARRIER;
  if (is_low) multiply_row(re, im, plane, lane);
  // In loops, of which PoCL (3.1) loses nothing.
  for (int k = lane - HALF_PX; k >= 0 && k < HALF_PX; k += HALF_PX) put_packed_row(plane, k);
  GROUP_BARRIER;
  if (lane == 0) get_packed_row(re, im, plane);
  GROUP_BARRIER;
  if (is_low) {
    fft_forward(re, im, FFT_PX);
    put_row_back(re, im, back, lane);
  } else {
    put_area_sums(&task, width, height, mean, sums, lane - HALF_PX);
  }
  GROUP_BARRIER;
  if (is_low) {
    get_columns(re, im, back, min(lane, COLUMNS - 1));
    fft_forward(re, im, FFT_PX);
  } else {
    put_norms((__local const float2*)sums, map, min_contrast * min_contrast * WINDOW_PIXELS,
              energy > 0.0f ? rsqrt(energy) * (1.0f / SCALE) : 0.0f, lane - HALF_PX);
  }
  GROUP_BARRIER;
  mark_out_of_view(map, task.place, lane);
  GROUP_BARRIER;
  if (lane < COLUMNS) put_correlation(re, im, map, highest, found, lane);
  GROUP_BARRIER;
  for (int k = lane; k < LAGS; k += LANES) {
    if (highest[k] == found[0].most) atomic_min(&found[0].x, k);
  }
  GROUP_BARRIER;
  for (int y = lane; y < LAGS; y += LANES) {
    if (in_order(map[y * LAGS + found[0].x]) == found[0].most) atomic_min(&found[0].y, y);
  }
  GROUP_BARRIER;
  const Patch patch = patch_about(task.place, found[0].x, found[0].y);
  atomic_max(&found[0].second, in_order(second_of_parts(map, found[0].x, found[0].y, lane)));
  for (int k = lane - HALF_PX; k >= 0 && k < PEAK_PATCH_PX; k += HALF_PX) {
    put_line(map, 1, patch, weights, lines, k);
  }
  GROUP_BARRIER;
  for (int k = lane - HALF_PX; k >= 0 && k < PEAK_PARTS; k += HALF_PX) {
    write_part(lines, patch, weights, k, peak);
  }
  for (int k = lane; k == 0; k += LANES) {
    write_head(map, 1, task.window, task.place, found[0].x, found[0].y, from_order(found[0].second),
               sqrt(energy * (1.0f / WINDOW_PIXELS)), min_contrast, peak);
  }
}
