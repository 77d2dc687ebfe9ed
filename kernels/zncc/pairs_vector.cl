// As pairs.cl, for devices whose work-items have wide vectors and share little: a work-item holds
// VECTOR neighbouring columns and takes BLOCKS of them in turn.
#ifndef VECTOR
#define VECTOR 8
#endif
#include "kernels/config.h"
#define MAP_SPACE __local
// Planes also hold the sums of both search areas, a row a lag.
#define SUM_ROWS (2 * (2 * SEARCH_PX + 1))
#define PLANE_ROWS (SUM_ROWS > FFT_PX ? SUM_ROWS : FFT_PX)
#include "kernels/zncc/pair.h"
#include "kernels/zncc/task.h"
#include "kernels/zncc/window_sums.h"

#define MAP (LAGS * LAGS)

#define PIXELS_AT(p) PASTE(convert_float, VECTOR)(LOAD(p))

// Pixels of the search area from (x, y) of it on, those of the nearest edge where it leaves the
// picture.
INLINE REAL area_pixels(const Task* task, const int width, const int height, const int x,
                        const int y) {
  const int px = task->place.x0 + x, py = clamp(task->place.y0 + y, 0, height - 1);
  __global const PIXEL* row = task->second + py * ROW;
  if (px >= 0 && px <= width - VECTOR) return PIXELS_AT(row + px);
  float pixels[VECTOR];
  for (int k = 0; k < VECTOR; ++k) pixels[k] = (float)row[clamp(px + k, 0, width - 1)];
  return LOAD(pixels);
}

// Pixels of the template from column x of row y on; 0 beyond its last column.
INLINE REAL template_pixels(const Task* task, const int width, const int height,
                            const float2 cos_sin, const int x, const int y) {
  if (task->window.guess_rot_rad == 0.0f && x + VECTOR <= WINDOW_PX) {
    return PIXELS_AT(task->first + (task->window.y0 + y) * ROW + task->window.x0 + x);
  }
  float pixels[VECTOR];
  for (int k = 0; k < VECTOR; ++k) {
    pixels[k] = x + k < WINDOW_PX
                    ? template_pixel(task->first, width, height, task->window, cos_sin, x + k, y)
                    : 0.0f;
  }
  return LOAD(pixels);
}

// Sums of the templates by column.
INLINE void put_template_sums(const Task* a, const Task* b, const int width, const int height,
                              __local float* sums, const int lane) {
  const float2 turn_a = guessed_turn(a->window), turn_b = guessed_turn(b->window);
  for (int block = 0; block < BLOCKS; ++block) {
    const int x = COLUMN(block);
    REAL sum_a = (REAL)(0.0f), sum_b = (REAL)(0.0f);
    for (int y = 0; x < WINDOW_PX && y < WINDOW_PX; ++y) {
      sum_a += template_pixels(a, width, height, turn_a, x, y);
      sum_b += template_pixels(b, width, height, turn_b, x, y);
    }
    PUT_VALUES(sum_a, sums + x);
    PUT_VALUES(sum_b, sums + FFT_PX + x);
  }
}

// Writes the templates into the rows 0 … WINDOW_PX − 1 of the plane.
INLINE void put_templates(const Task* a, const Task* b, const int width, const int height,
                          __local float* plane, const int x) {
  const float2 turn_a = guessed_turn(a->window), turn_b = guessed_turn(b->window);
  for (int y = 0; y < WINDOW_PX; ++y) {
    const REAL columns_a = template_pixels(a, width, height, turn_a, x, y);
    const REAL columns_b = template_pixels(b, width, height, turn_b, x, y);
    PUT(plane, x, y, columns_a, columns_b);
  }
}

// Sum of FFT_PX values.
INLINE float sum_of(__local const float* values) {
  float4 sum = vload4(0, values);
  UNROLL
  for (int k = 1; k < FFT_PX / 4; ++k) sum += vload4(k, values);
  return (sum.s0 + sum.s1) + (sum.s2 + sum.s3);
}

// Column spectra of the templates less their means; their energies by column.
INLINE void put_template_spectra(const Task* a, const Task* b, const int width, const int height,
                                 const float mean_a, const float mean_b, __local float* plane,
                                 __local float* energies, const int lane) {
  for (int block = 0; block < BLOCKS; ++block) {
    const int x = COLUMN(block);
    const INTEGER is_in = x + COLUMN_NUMBERS < WINDOW_PX;
    REAL re[FFT_PX], im[FFT_PX], energy_a = (REAL)(0.0f), energy_b = (REAL)(0.0f);
    if (x < WINDOW_PX) put_templates(a, b, width, height, plane, x);
    UNROLL
    for (int p = 0; p < FFT_PX; ++p) {
      const int y = fft_order(p, FFT_PX);
      re[p] = im[p] = (REAL)(0.0f);
      if (y >= WINDOW_PX) continue;
      GET(plane, x, y, re[p], im[p]);
      re[p] = is_in ? re[p] - mean_a : (REAL)(0.0f);
      im[p] = is_in ? im[p] - mean_b : (REAL)(0.0f);
      energy_a += re[p] * re[p];
      energy_b += im[p] * im[p];
    }
    PUT_VALUES(energy_a, energies + x);
    PUT_VALUES(energy_b, energies + FFT_PX + x);
    put_column_spectra(re, im, plane, x);
  }
}

// Search areas in order of rows, less the templates' means: any constant near the pixels' level
// keeps the sums of squares exact enough, and the numerator does not see it.
INLINE void get_area_columns(REAL* re, REAL* im, const Task* a, const Task* b, const int width,
                             const int height, const float mean_a, const float mean_b,
                             const int x) {
  UNROLL
  for (int y = 0; y < AREA_PX; ++y) {
    re[y] = area_pixels(a, width, height, x, y) - mean_a;
    im[y] = area_pixels(b, width, height, x, y) - mean_b;
  }
}

// Sums along the rows of put_column_sums', and the norm of every displaced window, into both maps.
INLINE void put_norms(__local const float* plane, __local float* maps, const float min_energy,
                      const int lane) {
  for (int j = lane; j < 2 * LAGS; j += LANES) {
    __local float* row = maps + j * LAGS;
    for (int x = 0; x < LAGS; x += VECTOR) {
      REAL sum = (REAL)(0.0f), squares = (REAL)(0.0f);
      for (int k = 0; k < WINDOW_PX; ++k) {
        REAL in, in_squares;
        GET(plane, x + k, j, in, in_squares);
        sum += in;
        squares += in_squares;
      }
      const REAL energy = squares - sum * sum * (1.0f / WINDOW_PIXELS);
      const INTEGER is_textured = energy > 0.01f * min_energy && energy > 0.0f;
      const REAL norms = is_textured ? rsqrt(energy) : (REAL)(0.0f);
      for (int k = 0; k < min(VECTOR, LAGS - x); ++k) row[x + k] = ELEMENT(norms, k);
    }
  }
}

// The numerators of columns x … times `scale` and the norms there: the correlation. −2 at lags that
// take the window out of the picture.
INLINE void put_correlation(const REAL* numerators, const float scale, const SearchPlace place,
                            __local float* map, const int x) {
  for (int k = 0; k < VECTOR && x + k < LAGS; ++k) {
    const int in_range = x + k >= place.min_x && x + k <= place.max_x;
    UNROLL
    for (int y = 0; y < LAGS; ++y) {
      __local float* value = map + y * LAGS + x + k;
      const float numerator = ELEMENT(numerators[y], k);
      const int is_valid = in_range && y >= place.min_y && y <= place.max_y;
      *value = is_valid ? *value * (scale * numerator) : -2.0f;
    }
  }
}

// Whether entry (x, y) of a map is at least as high as its neighbours.
INLINE int is_peak(__local const float* map, const int x, const int y) {
  const int left = max(x - 1, 0), right = min(x + 1, LAGS - 1);
  __local const float* above = map + max(y - 1, 0) * LAGS;
  __local const float* row = map + y * LAGS;
  __local const float* below = map + min(y + 1, LAGS - 1) * LAGS;
  float most = fmax(row[left], row[right]);
  most = fmax(most, fmax(fmax(above[left], above[right]), above[x]));
  most = fmax(most, fmax(fmax(below[left], below[right]), below[x]));
  return row[x] >= most;
}

// Highest value of both maps, the earliest of equal ones, as y · LAGS + x into found[0 … 1]; LAGS²
// where there is none. With only_peaks: among those that are peaks more than 2 px away from
// `around` along an axis. highest, indices: of every work-item, for both. All work-items of the
// group call it; passes barriers.
INLINE void find_highest(__local const float* maps, const int only_peaks, __local const int* around,
                         __local float* highest, __local int* indices, __local int* found,
                         const int lane) {
#pragma unroll 1
  for (int which = 0; which < 2; ++which) {
    __local const float* map = maps + which * MAP;
    const int far_x = only_peaks ? around[which] % LAGS : 0;
    const int far_y = only_peaks ? around[which] / LAGS : 0;
    float value = -1.5f;
    int index = LAGS * LAGS;
#pragma unroll 1
    for (int y = 0; y < LAGS; ++y) {
      for (int x = lane; x < LAGS; x += LANES) {
        if (map[y * LAGS + x] <= value) continue;
        if (only_peaks) {
          const int is_near = abs(x - far_x) <= 2 && abs(y - far_y) <= 2;
          if (is_near || !is_peak(map, x, y)) continue;
        }
        value = map[y * LAGS + x];
        index = y * LAGS + x;
      }
    }
    highest[which * LANES + lane] = value;
    indices[which * LANES + lane] = index;
    if (lane == 0) found[which] = LAGS * LAGS;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
#pragma unroll 1
  for (int which = 0; which < 2; ++which) {
    float most = highest[which * LANES];
    UNROLL
    for (int k = 1; k < LANES; ++k) most = fmax(most, highest[which * LANES + k]);
    const int own = which * LANES + lane;
    if (highest[own] == most) atomic_min(&found[which], indices[own]);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// energy: of the template. best, second: see find_highest. lines: PEAK_PATCH_PX. Passes a barrier.
INLINE void write_pair_peak(__local const float* map, const Task* own, const SearchPlace place,
                            const float energy, const float min_contrast, const int best,
                            const int second, __global const float* weights, __local float8* lines,
                            const int lane, const int is_wanted, __global CorrelationPeak* peak) {
  const int x = best % LAGS, y = best / LAGS;
  const Patch patch = patch_about(place, x, y);
  for (int k = lane; k < PEAK_PATCH_PX; k += LANES) put_line(map, 1, patch, weights, lines, k);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int part = lane; is_wanted && part < PEAK_PARTS; part += LANES) {
    write_part(lines, patch, weights, part, peak);
  }
  if (!is_wanted || lane > 0) return;
  write_head(map, 1, own->window, own->place, x, y, second < LAGS * LAGS ? map[second] : -2.0f,
             sqrt(energy * (1.0f / WINDOW_PIXELS)), min_contrast, peak);
}

// pixels: (slots, height, width); windows: start … start + count − 1 are measured; weights: of the
// peaks (types.h); peaks: (count) written. min_contrast: grey levels rms. One group of LANES two
// windows.
__kernel GROUP_SIZE void zncc_pairs(__global const PIXEL* pixels, const int width, const int height,
                                    __global const Window* windows, const uint start,
                                    const uint count, const float min_contrast,
                                    __global const float* weights,
                                    __global CorrelationPeak* peaks) {
  __local float plane[2 * PLANE] __attribute__((aligned(16)));
#if BLOCKS == 1
  __local float* g_plane = plane;
#else
  __local float g_plane[2 * PLANE];
#endif
  __local float maps[2 * MAP];
  __local float sums[2 * FFT_PX] __attribute__((aligned(16)));
  __local float energies[2 * FFT_PX] __attribute__((aligned(16)));
  __local float highest[2 * LANES];
  __local int indices[2 * LANES];
  __local int best[2], second[2];
  __local float8 lines[2][PEAK_PATCH_PX];
  const int lane = (int)get_local_id(0);
  const uint pair = 2 * (uint)get_group_id(0);
  Task a = task_of(pixels, width, height, windows[start + pair]);
  Task b = task_of(pixels, width, height, windows[start + min(pair + 1, count - 1)]);
  const int in_view_a = a.place.in_view, in_view_b = b.place.in_view;
  if (!in_view_a && !in_view_b) {
    if (lane < 2 && pair + (uint)lane < count) {
      peaks[pair + (uint)lane].status = STATUS_OUT_OF_VIEW;
      peaks[pair + (uint)lane].value = NAN;
#if LANES == 1
      if (pair + 1 < count) {
        peaks[pair + 1].status = STATUS_OUT_OF_VIEW;
        peaks[pair + 1].value = NAN;
      }
#endif
    }
    return;
  }
  // What is out of view is replaced by its partner and marked again in the end.
  const Task whole_a = in_view_a ? a : b, whole_b = in_view_b ? b : a;
  REAL g_re[FFT_PX], g_im[FFT_PX], re[FFT_PX], im[FFT_PX];

  put_template_sums(&whole_a, &whole_b, width, height, sums, lane);
  barrier(CLK_LOCAL_MEM_FENCE);
  const float mean_a = sum_of(sums) * (1.0f / WINDOW_PIXELS);
  const float mean_b = sum_of(sums + FFT_PX) * (1.0f / WINDOW_PIXELS);
  for (int block = 0; block < BLOCKS; ++block) {
    const int x = COLUMN(block);
    get_area_columns(re, im, &whole_a, &whole_b, width, height, mean_a, mean_b, x);
    put_column_sums(re, plane, x, 0);
    put_column_sums(im, plane, x, LAGS);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  put_norms(plane, maps, min_contrast * min_contrast * WINDOW_PIXELS, lane);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int block = 0; block < BLOCKS; ++block) {
    const int x = COLUMN(block);
#if BLOCKS > 1
    get_area_columns(re, im, &whole_a, &whole_b, width, height, mean_a, mean_b, x);
#endif
    UNROLL
    for (int p = 0; p < FFT_PX; ++p) {
      const int y = fft_order(p, FFT_PX);
      g_re[p] = y < AREA_PX ? re[y] : (REAL)(0.0f);
      g_im[p] = y < AREA_PX ? im[y] : (REAL)(0.0f);
    }
    put_column_spectra(g_re, g_im, plane, x);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int block = 0; block < BLOCKS; ++block) {
    const int y = COLUMN(block);
    get_row_spectra(g_re, g_im, plane, y);
#if BLOCKS > 1
    for (int k = 0; k < FFT_PX; ++k) PUT(g_plane, y, k, g_re[k], g_im[k]);
#endif
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  put_template_spectra(&whole_a, &whole_b, width, height, mean_a, mean_b, plane, energies, lane);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int block = 0; block < BLOCKS; ++block) {
    const int y = COLUMN(block);
    REAL f_re[FFT_PX], f_im[FFT_PX];
    get_row_spectra(f_re, f_im, plane, y);
#if BLOCKS > 1
    for (int k = 0; k < FFT_PX; ++k) GET(g_plane, y, k, g_re[k], g_im[k]);
#endif
    row_product(f_re, f_im, g_re, g_im, re, im, y);
    ALL_HAVE_READ;
    put_rows_back(re, im, g_plane, y);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const float energy_a = sum_of(energies), energy_b = sum_of(energies + FFT_PX);
  const float scale_a = energy_a > 0.0f ? rsqrt(energy_a) * (1.0f / PAIR_SCALE) : 0.0f;
  const float scale_b = energy_b > 0.0f ? rsqrt(energy_b) * (1.0f / PAIR_SCALE) : 0.0f;
  for (int block = 0; block < BLOCKS; ++block) {
    const int x = COLUMN(block);
    if (x >= LAGS) break;
    get_correlated_columns(re, im, g_plane, x);
    put_correlation(re, scale_a, whole_a.place, maps, x);
    put_correlation(im, scale_b, whole_b.place, maps + MAP, x);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  find_highest(maps, 0, best, highest, indices, best, lane);
  find_highest(maps, 1, best, highest, indices, second, lane);
  write_pair_peak(maps, &a, whole_a.place, energy_a, min_contrast, best[0], second[0], weights,
                  lines[0], lane, 1, peaks + pair);
  write_pair_peak(maps + MAP, &b, whole_b.place, energy_b, min_contrast, best[1], second[1],
                  weights, lines[1], lane, pair + 1 < count, peaks + pair + 1);
}
