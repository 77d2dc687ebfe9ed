// Zero-mean normalised cross-correlation (Lewis 1995) of two windows at a time in one kernel, for
// transforms of FFT_PX = 16 and 32 (kernels/pair.h): templates A and B, zero-padded, with their
// search areas. A work-item holds a column from end to end; pairs_vector.cl is the same for devices
// without many of them. FFT_PX ≥ WINDOW_PX + 2·SEARCH_PX keeps every lag free of wrap-around. What
// the numerator is divided by comes from exact sums over each displaced window.
#include "kernels/config.h"
#define MAP_SPACE __local
#include "kernels/zncc/map_peaks.h"
#include "kernels/zncc/pair.h"

// Where a template fills no more than half of the transform, the other half is left out of it.
#define IS_PADDED (2 * WINDOW_PX <= FFT_PX)
// Sums over columns of displaced windows, a row a lag: of A's pixels and squares, and of B's.
#define SUM_PITCH (FFT_PX + 1)
#define SUM_FLOATS (4 * LAGS * SUM_PITCH)
#define PLANE_FLOATS (2 * PLANE > SUM_FLOATS ? 2 * PLANE : SUM_FLOATS)

// Σ over the templates' columns. Elements from WINDOW_PX on are zero.
INLINE float2 sum_of_columns(__local const float4* columns) {
  float4 sum = columns[0];
  UNROLL
  for (int k = 1; k < (WINDOW_PX + 1) / 2; ++k) sum += columns[k];
  return sum.lo + sum.hi;
}

// Spectra of mean-free templates down their columns into the plane.
INLINE void put_template_spectra(const float* re, const float* im, __local float* plane,
                                 const int x) {
  float f_re[FFT_PX], f_im[FFT_PX];
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) {
    const int y = fft_order(p, FFT_PX);
    f_re[p] = y < WINDOW_PX ? re[y] : 0.0f;
    f_im[p] = y < WINDOW_PX ? im[y] : 0.0f;
  }
  if (IS_PADDED) {
    fft_forward_padded(f_re, f_im, FFT_PX);
  } else {
    fft_forward(f_re, f_im, FFT_PX);
  }
  if (x < WINDOW_PX) put_apart(f_re, f_im, plane, x);
}

// Their rows.
INLINE void get_template_rows(float* re, float* im, __local const float* plane, const int y) {
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) {
    const int x = fft_order(p, FFT_PX);
    re[p] = im[p] = 0.0f;
    if (x < WINDOW_PX) GET(plane, x, y, re[p], im[p]);
  }
  if (IS_PADDED) {
    fft_forward_padded(re, im, FFT_PX);
  } else {
    fft_forward(re, im, FFT_PX);
  }
}

// Sums of pixels and squares down the columns of every displaced window.
INLINE void put_column_sums(const float* a, const float* b, __local float4* sums, const int x) {
  float4 sum = 0.0f;
  UNROLL
  for (int y = 0; y < AREA_PX; ++y) {
    sum += (float4)(a[y], a[y] * a[y], b[y], b[y] * b[y]);
    if (y >= WINDOW_PX) {
      const int out = y - WINDOW_PX;
      sum -= (float4)(a[out], a[out] * a[out], b[out], b[out] * b[out]);
    }
    if (y >= WINDOW_PX - 1) sums[(y - WINDOW_PX + 1) * SUM_PITCH + x] = sum;
  }
}

// Sums along the rows of those, and the norm of every displaced window, into both maps.
INLINE void put_norms(__local const float4* sums, __local float2* maps, const float min_energy,
                      const int lane) {
  for (int j = lane; j < LAGS; j += LANES) {
    __local const float4* row = sums + j * SUM_PITCH;
    float4 sum = 0.0f;
    UNROLL
    for (int x = 0; x < AREA_PX; ++x) {
      sum += row[x];
      if (x >= WINDOW_PX) sum -= row[x - WINDOW_PX];
      if (x >= WINDOW_PX - 1) {
        maps[j * LAGS + x - WINDOW_PX + 1] = (float2)(inverse_norm(sum.x, sum.y, min_energy),
                                                      inverse_norm(sum.z, sum.w, min_energy));
      }
    }
  }
}

// Spectra of search areas down their columns into the plane.
INLINE void put_area_spectra(const float* a, const float* b, __local float* plane, const int x) {
  float re[FFT_PX], im[FFT_PX];
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) {
    const int y = fft_order(p, FFT_PX);
    re[p] = y < AREA_PX ? a[y] : 0.0f;
    im[p] = y < AREA_PX ? b[y] : 0.0f;
  }
  put_column_spectra(re, im, plane, x);
}

// pixels: (slots, height, width); windows: start … start + count − 1 are measured; weights: of the
// peaks (types.h); peaks: (count) written. min_contrast: grey levels rms. One group of LANES =
// FFT_PX two windows.
__kernel GROUP_SIZE void zncc_pairs(__global const PIXEL* pixels, const int width, const int height,
                                    __global const Window* windows, const uint start,
                                    const uint count, const float min_contrast,
                                    __global const float* weights,
                                    __global CorrelationPeak* peaks) {
  __local float plane[PLANE_FLOATS] __attribute__((aligned(16)));
  __local float scratch[PACKED > 16 * PEAK_LINES ? PACKED : 16 * PEAK_LINES]
      __attribute__((aligned(32)));
  __local float2 maps[LAGS * LAGS];
  __local float2 sums[FFT_PX] __attribute__((aligned(16)));
  __local float2 energies[FFT_PX] __attribute__((aligned(16)));
  __local Found found[2];
  const int lane = (int)get_local_id(0);
  const uint pair = 2 * (uint)get_group_id(0);
  const Task a = task_of(pixels, width, height, windows[start + pair]);
  const Task b = task_of(pixels, width, height, windows[start + min(pair + 1, count - 1)]);
  const int in_view_a = a.place.in_view, in_view_b = b.place.in_view;
  if (!in_view_a && !in_view_b) {
    if (lane < 2 && pair + (uint)lane < count) {
      peaks[pair + (uint)lane].status = STATUS_OUT_OF_VIEW;
      peaks[pair + (uint)lane].value = NAN;
    }
    return;
  }
  // What is out of view is replaced by its partner and marked again in the end.
  const Task whole_a = in_view_a ? a : b, whole_b = in_view_b ? b : a;
  const int is_template = lane < WINDOW_PX;
  clear_found(found, 2, lane);

  float t_re[WINDOW_PX], t_im[WINDOW_PX], g_a[AREA_PX], g_b[AREA_PX];
  get_template(&whole_a, width, height, plane + lane, PITCH, lane, t_re);
  get_template(&whole_b, width, height, plane + PLANE + lane, PITCH, lane, t_im);
  float2 sum = 0.0f;
  UNROLL
  for (int y = 0; y < WINDOW_PX; ++y) sum += (float2)(t_re[y], t_im[y]);
  sums[lane] = is_template ? sum : 0.0f;
  // Before the barrier, so that the pixels travel meanwhile.
  get_area(&whole_a, width, height, plane + lane, PITCH, lane, g_a);
  get_area(&whole_b, width, height, plane + lane, PITCH, lane, g_b);
  GROUP_BARRIER;
  const float2 mean = sum_of_columns((__local const float4*)sums) * (1.0f / WINDOW_PIXELS);
  sum = 0.0f;
  UNROLL
  for (int y = 0; y < WINDOW_PX; ++y) {
    t_re[y] -= mean.x;
    t_im[y] -= mean.y;
    sum += (float2)(t_re[y] * t_re[y], t_im[y] * t_im[y]);
  }
  energies[lane] = is_template ? sum : 0.0f;
  // Any constant near the pixels' level keeps the sums of squares exact enough, and the numerator
  // does not see it.
  UNROLL
  for (int y = 0; y < AREA_PX; ++y) {
    g_a[y] -= mean.x;
    g_b[y] -= mean.y;
  }
  put_column_sums(g_a, g_b, (__local float4*)plane, lane);
  GROUP_BARRIER;
  put_norms((__local const float4*)plane, maps, min_contrast * min_contrast * WINDOW_PIXELS, lane);
  GROUP_BARRIER;
  float f_re[FFT_PX], f_im[FFT_PX], g_re[FFT_PX], g_im[FFT_PX], re[FFT_PX], im[FFT_PX];
  put_template_spectra(t_re, t_im, plane, lane);
  GROUP_BARRIER;
  get_template_rows(f_re, f_im, plane, lane);
  put_packed(f_re, f_im, scratch, 0, lane);
  GROUP_BARRIER;
  put_area_spectra(g_a, g_b, plane, lane);
  GROUP_BARRIER;
  get_row_spectra(g_re, g_im, plane, lane);
  put_packed(g_re, g_im, scratch, 1, lane);
  GROUP_BARRIER;
  multiply_packed(scratch, lane);
  GROUP_BARRIER;
  row_product(f_re, f_im, g_re, g_im, scratch, re, im, lane);
  fft_forward(re, im, FFT_PX);
  UNROLL
  for (int x = 0; x < LAGS; ++x) PUT(plane, lane, x, re[x], im[x]);
  GROUP_BARRIER;

  const float2 energy = sum_of_columns((__local const float4*)energies);
  const float2 scale = (float2)(energy.x > 0.0f ? rsqrt(energy.x) * (1.0f / PAIR_SCALE) : 0.0f,
                                energy.y > 0.0f ? rsqrt(energy.y) * (1.0f / PAIR_SCALE) : 0.0f);
  const int x = min(lane, LAGS - 1);
  get_correlated_columns(re, im, plane, x);
  UNROLL
  for (int y = 0; y < LAGS; ++y) {
    const float2 norm = maps[y * LAGS + x] * scale;
    re[y] *= norm.x;
    im[y] *= norm.y;
  }
  GROUP_BARRIER;
  mark_lags_out_of_view(re, whole_a.place, x);
  mark_lags_out_of_view(im, whole_b.place, x);
  find_peaks(re, im, maps, found, x);
  put_second_peaks(re, im, maps, found, x);
  const Patch patch_a = patch_about(whole_a.place, found[0].x, found[0].y);
  const Patch patch_b = patch_about(whole_b.place, found[1].x, found[1].y);
  for (int k = lane; k < 32; k += LANES) {
    const Patch patch = k < 16 ? patch_a : patch_b;
    if (k % 16 >= PEAK_PATCH_PX) continue;
    put_line((__local const float*)maps + k / 16, 2, patch, weights,
             (__local float8*)scratch + k / 16 * PEAK_PATCH_PX, k % 16);
  }
  GROUP_BARRIER;
  for (int k = lane; k < 32; k += LANES) {
    const int which = k / 16;
    if (pair + (uint)which >= count) continue;
    if (k % 16 < PEAK_PARTS) {
      write_part((__local const float8*)scratch + which * PEAK_PATCH_PX,
                 which == 0 ? patch_a : patch_b, weights, k % 16, peaks + pair + which);
    } else if (k % 16 == 15) {
      const Task own = which == 0 ? a : b;
      const float contrast = sqrt((which == 0 ? energy.x : energy.y) * (1.0f / WINDOW_PIXELS));
      write_head((__local const float*)maps + which, 2, own.window, own.place, found[which].x,
                 found[which].y, from_order(found[which].second), contrast, min_contrast,
                 peaks + pair + which);
    }
  }
}
