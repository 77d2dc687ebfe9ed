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
// divided by comes from exact sums over each displaced window.
#include "kernels/config.h"
#define MAP_SPACE __local
#include "kernels/fft.h"
#include "kernels/map_peaks.h"

#define HALF_PX (FFT_PX / 2)
// Work-items that hold columns x and x + COLUMNS of the map; the last may have but one.
#define COLUMNS ((LAGS + 1) / 2)
// Of what the transforms leave over Σ t(x) g(x + l).
#define SCALE (4.0f * FFT_PX * FFT_PX)

// Column x of template and search area, mean-free, to column x of their common spectrum.
INLINE void put_spectrum(const float* t, const float* g, __local float* plane, const int x) {
  float re[FFT_PX], im[FFT_PX];
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) {
    const int y = fft_order(p, FFT_PX);
    re[p] = y < WINDOW_PX ? t[y] : 0.0f;
    im[p] = y < AREA_PX ? g[y] : 0.0f;
  }
  fft_forward(re, im, FFT_PX);
  UNROLL
  for (int k = 0; k < FFT_PX; ++k) PUT(plane, x, k, re[k], im[k]);
}

// Sums of pixels and squares down the columns of every displaced window.
INLINE void put_column_sums(const float* pixels, __local float* plane, const int x) {
  float sum = 0.0f, squares = 0.0f;
  UNROLL
  for (int y = 0; y < AREA_PX; ++y) {
    sum += pixels[y];
    squares += pixels[y] * pixels[y];
    if (y >= WINDOW_PX) {
      sum -= pixels[y - WINDOW_PX];
      squares -= pixels[y - WINDOW_PX] * pixels[y - WINDOW_PX];
    }
    if (y >= WINDOW_PX - 1) PUT(plane, x, y - WINDOW_PX + 1, sum, squares);
  }
}

// Sums along the rows of those, and the norm of every displaced window, into the map: a row a
// work-item of the first half, and the rows beyond an entry a work-item of the other half.
INLINE void put_norms(__local const float* plane, __local float* map, const float min_energy,
                      const int lane) {
  if (lane < min(LAGS, HALF_PX)) {
    float sum = 0.0f, squares = 0.0f;
    UNROLL
    for (int x = 0; x < AREA_PX; ++x) {
      float in, in_squares;
      GET(plane, x, lane, in, in_squares);
      sum += in;
      squares += in_squares;
      if (x >= WINDOW_PX) {
        GET(plane, x - WINDOW_PX, lane, in, in_squares);
        sum -= in;
        squares -= in_squares;
      }
      if (x >= WINDOW_PX - 1) {
        map[lane * LAGS + x - WINDOW_PX + 1] = inverse_norm(sum, squares, min_energy);
      }
    }
  }
#pragma unroll 1
  for (int k = lane - HALF_PX; k >= 0 && k < (LAGS - HALF_PX) * LAGS; k += HALF_PX) {
    const int y = HALF_PX + k / LAGS, x = k % LAGS;
    float sum = 0.0f, squares = 0.0f;
#pragma unroll 8
    for (int i = 0; i < WINDOW_PX; ++i) {
      float in, in_squares;
      GET(plane, x + i, y, in, in_squares);
      sum += in;
      squares += in_squares;
    }
    map[y * LAGS + x] = inverse_norm(sum, squares, min_energy);
  }
}

// 4 t^* g^ at (kx, ky).
INLINE float2 product_at(__local const float* plane, const int kx, const int ky) {
  float z_re, z_im, m_re, m_im;
  GET(plane, ky, kx, z_re, z_im);
  GET(plane, (FFT_PX - ky) % FFT_PX, (FFT_PX - kx) % FFT_PX, m_re, m_im);
  const float t_re = z_re + m_re, t_im = z_im - m_im;
  const float g_re = z_im + m_im, g_im = m_re - z_re;
  return (float2)(t_re * g_re + t_im * g_im, t_re * g_im - t_im * g_re);
}

// Columns x and x + COLUMNS of the map from the rows of the product that came back, times SCALE.
INLINE void get_columns(float* re, float* im, __local const float* plane, const int x) {
  const int other = min(x + COLUMNS, LAGS - 1);
  float a_re, a_im, b_re, b_im;
  GET(plane, 0, x, a_re, a_im);
  GET(plane, 0, other, b_re, b_im);
  re[0] = a_re;
  im[0] = b_re;
  re[1] = a_im;
  im[1] = b_im;
  UNROLL
  for (int k = 1; k < HALF_PX; ++k) {
    const int p = fft_order(k, FFT_PX), m = fft_order(FFT_PX - k, FFT_PX);
    GET(plane, k, x, a_re, a_im);
    GET(plane, k, other, b_re, b_im);
    re[p] = a_re - b_im;
    im[p] = a_im + b_re;
    re[m] = a_re + b_im;
    im[m] = b_re - a_im;
  }
  fft_forward(im, re, FFT_PX);
}

// Sum of FFT_PX values.
INLINE float sum_of(__local const float* values) {
  float4 sum = vload4(0, values);
  UNROLL
  for (int k = 1; k < FFT_PX / 4; ++k) sum += vload4(k, values);
  return (sum.s0 + sum.s1) + (sum.s2 + sum.s3);
}

// Of every entry of column x the higher one of its neighbours left and right.
INLINE void get_beside(float* beside, __local const float* map, const int x) {
  __local const float* left = map + max(x - 1, 0);
  __local const float* right = map + min(x + 1, LAGS - 1);
  UNROLL
  for (int y = 0; y < LAGS; ++y) beside[y] = fmax(left[y * LAGS], right[y * LAGS]);
}

// pixels: (slots, height, width); windows: from `start` on; weights: of the
// peaks (types.h); peaks: (count) written. min_contrast: grey levels rms. One group of LANES =
// FFT_PX a window.
__kernel GROUP_SIZE void zncc_single(__global const PIXEL* pixels, const int width,
                                     const int height, __global const Window* windows,
                                     const uint start, const float min_contrast,
                                     __global const float* weights,
                                     __global CorrelationPeak* peaks) {
  __local float plane[2 * PLANE] __attribute__((aligned(32)));
  __local float8* lines = (__local float8*)plane;  // in the end
  __local float map[LAGS * LAGS];
  // The end of the plane, which the sums over displaced windows and what comes back do not reach.
  __local float* sums = plane + 2 * PLANE - FFT_PX;
  __local float* energies = sums - FFT_PX;
  __local float2* middle = (__local float2*)energies;  // row FFT_PX/2 of the product
  __local int highest[LAGS];                           // of each column, in_order
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

  float t[WINDOW_PX], g[AREA_PX], sum = 0.0f;
  get_template(&task, width, height, plane + lane, PITCH, lane, t);
  get_area(&task, width, height, lane, g);
  UNROLL
  for (int y = 0; y < WINDOW_PX; ++y) sum += t[y];
  sums[lane] = lane < WINDOW_PX ? sum : 0.0f;
  GROUP_BARRIER;
  // Any constant near the pixels' level keeps the sums of squares exact enough, and the numerator
  // does not see it.
  const float mean = sum_of(sums) * (1.0f / WINDOW_PIXELS);
  sum = 0.0f;
  UNROLL
  for (int y = 0; y < WINDOW_PX; ++y) {
    t[y] = lane < WINDOW_PX ? t[y] - mean : 0.0f;
    sum += t[y] * t[y];
  }
  energies[lane] = sum;
  UNROLL
  for (int y = 0; y < AREA_PX; ++y) g[y] -= mean;
  put_column_sums(g, plane, lane);
  GROUP_BARRIER;
  const float energy = sum_of(energies);
  put_norms(plane, map, min_contrast * min_contrast * WINDOW_PIXELS, lane);
  GROUP_BARRIER;

  float re[FFT_PX], im[FFT_PX];
  put_spectrum(t, g, plane, lane);
  GROUP_BARRIER;
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) GET(plane, fft_order(p, FFT_PX), lane, re[p], im[p]);
  fft_forward(re, im, FFT_PX);
  GROUP_BARRIER;
  UNROLL
  for (int k = 0; k < FFT_PX; ++k) PUT(plane, lane, k, re[k], im[k]);
  GROUP_BARRIER;

  // The first half of the work-items takes a row of the product each, the other half row FFT_PX/2.
  float2 low = 0.0f, high = 0.0f;
  if (lane >= HALF_PX) {
    low = product_at(plane, lane - HALF_PX, HALF_PX);
    high = product_at(plane, lane, HALF_PX);
  } else {
    UNROLL
    for (int p = 0; p < FFT_PX; ++p) {
      const float2 product = product_at(plane, fft_order(p, FFT_PX), lane);
      re[p] = product.x;
      im[p] = product.y;
    }
  }
  GROUP_BARRIER;
  if (lane >= HALF_PX) {
    middle[lane - HALF_PX] = low;
    middle[lane] = high;
  }
  GROUP_BARRIER;
  if (lane < HALF_PX) {
    if (lane == 0) {
      UNROLL
      for (int p = 0; p < FFT_PX; ++p) {
        const float2 product = middle[fft_order(p, FFT_PX)];
        re[p] -= product.y;
        im[p] += product.x;
      }
    }
    fft_forward(im, re, FFT_PX);
    UNROLL
    for (int x = 0; x < LAGS; ++x) PUT(plane, lane, x, re[x], im[x]);
  }
  GROUP_BARRIER;

  const float scale = energy > 0.0f ? rsqrt(energy) * (1.0f / SCALE) : 0.0f;
  const int x_a = min(lane, COLUMNS - 1), x_b = x_a + COLUMNS, has_both = x_b < LAGS;
  if (lane < COLUMNS) {
    get_columns(re, im, plane, x_a);
    // Nobody else looks at these columns of the map yet.
    float highest_a = -2.0f, highest_b = -2.0f;
    __local float* column_a = map + x_a;
    __local float* column_b = map + (has_both ? x_b : x_a);
    UNROLL
    for (int y = 0; y < LAGS; ++y) {
      re[y] *= scale * column_a[y * LAGS];
      im[y] = has_both ? im[y] * (scale * column_b[y * LAGS]) : -2.0f;
    }
    mark_lags_out_of_view(re, task.place, x_a);
    mark_lags_out_of_view(im, task.place, x_b);
    UNROLL
    for (int y = 0; y < LAGS; ++y) {
      column_a[y * LAGS] = re[y];
      if (has_both) column_b[y * LAGS] = im[y];
      highest_a = fmax(highest_a, re[y]);
      highest_b = fmax(highest_b, im[y]);
    }
    highest[x_a] = in_order(highest_a);
    if (has_both) highest[x_b] = in_order(highest_b);
    atomic_max(&found[0].most, in_order(fmax(highest_a, highest_b)));
  }
  GROUP_BARRIER;
  for (int k = lane; k < LAGS; k += LANES) {
    if (highest[k] == found[0].most) atomic_min(&found[0].x, k);
  }
  GROUP_BARRIER;
  for (int y = lane; y < LAGS; y += LANES) {
    if (in_order(map[y * LAGS + found[0].x]) == found[0].most) atomic_min(&found[0].y, y);
  }
  GROUP_BARRIER;
  {
    const int x = found[0].x, y = found[0].y;
    const Patch patch = patch_about(task.place, x, y);
    if (lane < COLUMNS) {
      float beside[LAGS];
      get_beside(beside, map, x_a);
      const float second_a = second_of_column(re, beside, x_a, x, y);
      get_beside(beside, map, has_both ? x_b : x_a);
      const float second_b = second_of_column(im, beside, x_b, x, y);
      atomic_max(&found[0].second, in_order(fmax(second_a, second_b)));
    }
    for (int k = lane - HALF_PX; k >= 0 && k < PEAK_PATCH_PX; k += HALF_PX) {
      put_line(map, 1, patch, weights, lines, k);
    }
  }
  GROUP_BARRIER;
  const Patch patch = patch_about(task.place, found[0].x, found[0].y);
  // In a loop, of which PoCL (3.1) loses nothing.
  for (int k = lane; k < 2 * LANES; k += LANES) {
    if (k < PEAK_PARTS) write_part(lines, patch, weights, k, peak);
    if (k != LANES) continue;
    write_head(map, 1, task.window, task.place, found[0].x, found[0].y, from_order(found[0].second),
               sqrt(energy * (1.0f / WINDOW_PIXELS)), min_contrast, peak);
  }
}
