// As single.cl, for devices whose work-items have wide vectors and share little; all rows and
// columns are transformed there and back.
//
// Template t (zero-padded) and search area g, both mean-free, are the real and the imaginary part
// of one picture, so that one forward transform Z serves both (hats: spectra):
//   t^(k) = (Z(k) + Z*(−k))/2,  g^(k) = (Z(k) − Z*(−k))/2i,  Σ t(x) g(x + l) = F⁻¹[t^* g^](l).
// The spectra never leave local memory. FFT_PX ≥ WINDOW_PX + 2·SEARCH_PX keeps every lag free of
// wrap-around. What the numerator is divided by comes from exact sums over each displaced window.
//
// LANES work-items share a window; each holds VECTOR neighbouring columns and takes BLOCKS of them
// in turn.
#define MAP_SPACE __local
#ifndef VECTOR
#define VECTOR 8
#endif
#include "kernels/config.h"
#include "kernels/lanes.h"
#if VECTOR == 4
#define LOAD_REVERSED(p) (LOAD((p)-3).s3210)
#elif VECTOR == 8
#define LOAD_REVERSED(p) (LOAD((p)-7).s76543210)
#else
#define LOAD_REVERSED(p) (LOAD((p)-15).sfedcba9876543210)
#endif

#include "kernels/fft.h"
#include "kernels/zncc/window_sums.h"

#if BLOCKS == 1
#define PLANES 1
#else
#define PLANES 2
#endif

INLINE void fft_ordered(REAL* re, REAL* im) {
  REAL a[FFT_PX], b[FFT_PX];
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) {
    a[p] = re[fft_order(p, FFT_PX)];
    b[p] = im[fft_order(p, FFT_PX)];
  }
  fft_forward(a, b, FFT_PX);
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) {
    re[p] = a[p];
    im[p] = b[p];
  }
}

// VECTOR pixels of the search area from (x, y) on.
static inline REAL area_pixels(__global const float* image, const int width, const int height,
                               const int x, const int y) {
  if (x >= 0 && x <= width - VECTOR) {
    return LOAD(image + clamp(y, 0, height - 1) * width + x);
  }
  float pixels[VECTOR];
  for (int k = 0; k < VECTOR; ++k) {
    pixels[k] = clamped_pixel(image, width, height, add_sat(x, k), y);
  }
  return LOAD(pixels);
}

// VECTOR pixels of the template from column i of row j on; 0 beyond its last column.
static inline REAL template_pixels(__global const float* image, const int width, const int height,
                                   const Window window, const float2 cos_sin, const int i,
                                   const int j) {
  if (window.guess_rot_rad == 0.0f && i + VECTOR <= WINDOW_PX && window.x0 >= 0 &&
      window.x0 <= width - WINDOW_PX) {
    return LOAD(image + clamp(window.y0 + j, 0, height - 1) * width + window.x0 + i);
  }
  float pixels[VECTOR];
  for (int k = 0; k < VECTOR; ++k) {
    pixels[k] =
        i + k < WINDOW_PX ? template_pixel(image, width, height, window, cos_sin, i + k, j) : 0.0f;
  }
  return LOAD(pixels);
}

// Sum over the window's work-items, for all of them. Passes two barriers.
static inline float sum_of_lanes(__local float* values, const int lane, const float value) {
  values[lane] = value;
  barrier(CLK_LOCAL_MEM_FENCE);
  float sum = 0.0f;
  for (int k = 0; k < LANES; ++k) sum += values[k];
  barrier(CLK_LOCAL_MEM_FENCE);
  return sum;
}

// images: (slots, height, width); windows: from `start` on; weights: of the
// peaks (types.h); peaks: (count) written. min_contrast: grey levels rms. A group a window.
__kernel GROUP_SIZE void zncc_single(__global const float* images, const int width,
                                     const int height, __global const Window* windows,
                                     const uint start, const float min_contrast,
                                     __global const float* weights,
                                     __global CorrelationPeak* peaks) {
  __local float planes[PLANES * 2 * PLANE];
  __local float map[LAGS * LAGS];
  __local float values[LANES];
  __local int indices[LANES];
  __local float8 lines[PEAK_PATCH_PX];
  const int lane = (int)get_local_id(0);
  const uint at = (uint)get_group_id(0);
  const Window window = windows[start + at];
  const SearchPlace place = search_place(window, width, height);
  const float2 cos_sin = guessed_turn(window);
  const size_t frame = (size_t)width * (size_t)height;
  __global const float* first = images + frame * (size_t)window.first;
  __global const float* second = images + frame * (size_t)window.second;
  __local float* a_re = planes;
  __local float* a_im = a_re + PLANE;
  __local float* b_re = a_re + (PLANES - 1) * 2 * PLANE;
  __local float* b_im = b_re + PLANE;
  REAL re[FFT_PX], im[FFT_PX];

  // Pixels and their means.
  REAL template_sum = (REAL)(0.0f), area_sum = (REAL)(0.0f);
  for (int b = 0; b < BLOCKS; ++b) {
    const int x = COLUMN(b);
    UNROLL
    for (int y = 0; y < FFT_PX; ++y) {
      re[y] = (REAL)(0.0f);
      im[y] = (REAL)(0.0f);
      if (y < WINDOW_PX && x < WINDOW_PX) {
        re[y] = template_pixels(first, width, height, window, cos_sin, x, y);
      }
      if (y < AREA_PX) {
        im[y] = area_pixels(second, width, height, add_sat(place.x0, x), add_sat(place.y0, y));
      }
      template_sum += re[y];
      area_sum += im[y];
#if BLOCKS > 1
      STORE(re[y], a_re + y * PITCH + x);
      STORE(im[y], a_im + y * PITCH + x);
#endif
    }
  }
  const float template_mean =
      sum_of_lanes(values, lane, SUM(template_sum)) * (1.0f / WINDOW_PIXELS);
  // Any constant near the pixels' level keeps the sums of squares exact enough; the numerator does
  // not see it, the template being mean-free.
  const float area_level = sum_of_lanes(values, lane, SUM(area_sum)) * (1.0f / (AREA_PX * FFT_PX));

  // Mean-free pixels; sums down the columns of every displaced window.
  REAL energy = (REAL)(0.0f);
  for (int b = 0; b < BLOCKS; ++b) {
    const int x = COLUMN(b);
    UNROLL
    for (int y = 0; y < AREA_PX; ++y) {
#if BLOCKS > 1
      re[y] = LOAD(a_re + y * PITCH + x);
      im[y] = LOAD(a_im + y * PITCH + x);
#endif
      if (y < WINDOW_PX) {
        re[y] = x + COLUMN_NUMBERS < WINDOW_PX ? re[y] - template_mean : (REAL)(0.0f);
        energy += re[y] * re[y];
      }
      im[y] -= area_level;
#if BLOCKS > 1
      STORE(re[y], a_re + y * PITCH + x);
      STORE(im[y], a_im + y * PITCH + x);
#endif
    }
    put_column_sums(im, b_re, x, 0);
  }
  const float template_energy = sum_of_lanes(values, lane, SUM(energy));
  const float min_energy = min_contrast * min_contrast * WINDOW_PIXELS;

  // Sums along the rows of those, and the norm of every displaced window.
  for (int j = lane; j < LAGS; j += LANES) {
    float sum = 0.0f, squares = 0.0f;
    for (int x = 0; x < AREA_PX; ++x) {
      sum += b_re[j * PITCH + x];
      squares += b_im[j * PITCH + x];
      if (x >= WINDOW_PX) {
        sum -= b_re[j * PITCH + x - WINDOW_PX];
        squares -= b_im[j * PITCH + x - WINDOW_PX];
      }
      if (x >= WINDOW_PX - 1) {
        map[j * LAGS + x - WINDOW_PX + 1] = inverse_norm(sum, squares, min_energy);
      }
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);

  // Transform down the columns …
  for (int b = 0; b < BLOCKS; ++b) {
    const int x = COLUMN(b);
#if BLOCKS > 1
    UNROLL
    for (int y = 0; y < FFT_PX; ++y) {
      re[y] = LOAD(a_re + y * PITCH + x);
      im[y] = LOAD(a_im + y * PITCH + x);
    }
#endif
    fft_ordered(re, im);
    UNROLL
    for (int p = 0; p < FFT_PX; ++p) {
      STORE(re[p], a_re + p * PITCH + x);
      STORE(im[p], a_im + p * PITCH + x);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);

  // … and along the rows: Z(k), a column of the plane being a row of the spectrum. Column FFT_PX
  // repeats column 0, so that −k can be read backwards.
  for (int b = 0; b < BLOCKS; ++b) {
    const int ky = COLUMN(b);
    UNROLL
    for (int x = 0; x < FFT_PX; ++x) {
      re[x] = LOAD_ACROSS(a_re + ky * PITCH + x);
      im[x] = LOAD_ACROSS(a_im + ky * PITCH + x);
    }
    fft_ordered(re, im);
    ALL_HAVE_READ;
    UNROLL
    for (int p = 0; p < FFT_PX; ++p) {
      const int row = p * PITCH;
      STORE(re[p], b_re + row + ky);
      STORE(im[p], b_im + row + ky);
      if (ky == 0) {
        b_re[row + FFT_PX] = b_re[row];
        b_im[row + FFT_PX] = b_im[row];
      }
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);

  // Cross-power spectrum (times 4), and back along the rows.
  for (int b = 0; b < BLOCKS; ++b) {
    const int ky = COLUMN(b);
    UNROLL
    for (int kx = 0; kx < FFT_PX; ++kx) {
      const int row = kx * PITCH + ky;
      const int mirrored = ((FFT_PX - kx) % FFT_PX) * PITCH + FFT_PX - ky;
      const REAL z_re = LOAD(b_re + row), z_im = LOAD(b_im + row);
      const REAL m_re = LOAD_REVERSED(b_re + mirrored), m_im = LOAD_REVERSED(b_im + mirrored);
      const REAL t_re = z_re + m_re, t_im = z_im - m_im;
      const REAL g_re = z_im + m_im, g_im = m_re - z_re;
      re[kx] = t_re * g_re + t_im * g_im;
      im[kx] = t_re * g_im - t_im * g_re;
    }
    fft_ordered(im, re);
    ALL_HAVE_READ;
    UNROLL
    for (int p = 0; p < FFT_PX; ++p) {
      STORE(re[p], a_re + p * PITCH + ky);
      STORE(im[p], a_im + p * PITCH + ky);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);

  // Back down the columns: the numerators, and with the norms the correlation.
  const float scale =
      template_energy > 0.0f ? rsqrt(template_energy) * (0.25f / (FFT_PX * FFT_PX)) : 0.0f;
  for (int b = 0; b < BLOCKS; ++b) {
    const int x = COLUMN(b);
    if (x < LAGS) {
      UNROLL
      for (int ky = 0; ky < FFT_PX; ++ky) {
        re[ky] = LOAD_ACROSS(a_re + x * PITCH + ky);
        im[ky] = LOAD_ACROSS(a_im + x * PITCH + ky);
      }
      fft_ordered(im, re);
      UNROLL
      for (int p = 0; p < FFT_PX; ++p) {
        const int y = p;
        if (y < LAGS) {
          float numerators[VECTOR];
          STORE(re[p], numerators);
          for (int k = 0; k < min(VECTOR, LAGS - x); ++k) {
            map[y * LAGS + x + k] *= scale * numerators[k];
          }
        }
      }
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  write_peak(map, window, place, sqrt(template_energy * (1.0f / WINDOW_PIXELS)), min_contrast,
             weights, values, indices, lines, lane, LANES, peaks + at);
}
