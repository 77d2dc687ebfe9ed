// Circular cross-correlation of two pairs of real windows A and B at once, FFT_PX × FFT_PX, in
// registers and local memory (kernels/lanes.h).
//
// Columns of A and B are the real and the imaginary part of one transform, whose frequencies k and
// −k lie in the same work-item: there A and B part, FFT_PX/2 rows of each remain (the others are
// their conjugates), the real rows 0 and FFT_PX/2 of a window packed as one complex row. Rows 0 …
// FFT_PX/2 − 1 of a plane are A's, the rest are B's: as many transforms along rows as there are
// columns. Nothing but two transpositions there and one back goes through local memory.
#ifndef IMPACTDIC_KERNELS_PAIR_H_
#define IMPACTDIC_KERNELS_PAIR_H_

#include "kernels/fft.h"
#include "kernels/lanes.h"

#define HALF_PX (FFT_PX / 2)
// Of what the transforms leave over the correlation Σ f(x) g(x + l).
#define PAIR_SCALE (4.0f * FFT_PX * FFT_PX)

// Writes A's and B's spectra (but for the rows 0: twice them) from transformed columns x … (re: A,
// im: B).
INLINE void put_apart(const REAL* re, const REAL* im, __local float* plane, const int x) {
  PUT(plane, x, 0, re[0], re[HALF_PX]);
  PUT(plane, x, HALF_PX, im[0], im[HALF_PX]);
  UNROLL
  for (int k = 1; k < HALF_PX; ++k) {
    const int m = FFT_PX - k;
    PUT(plane, x, k, re[k] + re[m], im[k] - im[m]);
    PUT(plane, x, HALF_PX + k, im[k] + im[m], re[m] - re[k]);
  }
}

// The same of columns in fft_order.
INLINE void put_column_spectra(REAL* re, REAL* im, __local float* plane, const int x) {
  fft_forward(re, im, FFT_PX);
  put_apart(re, im, plane, x);
}

// Rows y … of a plane, in fft_order.
INLINE void get_rows(REAL* re, REAL* im, __local const float* plane, const int y) {
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) GET_ACROSS(plane, fft_order(p, FFT_PX), y, re[p], im[p]);
}

// Their spectra in order.
INLINE void get_row_spectra(REAL* re, REAL* im, __local const float* plane, const int y) {
  get_rows(re, im, plane, y);
  fft_forward(re, im, FFT_PX);
}

// The product f* g of a packed row at frequencies k and m = −k. A packed row is F0 + i F1 with
// Hermitian F0 and F1, and so is its product.
INLINE void packed_product(const REAL fk_re, const REAL fk_im, const REAL fm_re, const REAL fm_im,
                           const REAL gk_re, const REAL gk_im, const REAL gm_re, const REAL gm_im,
                           REAL* k_re, REAL* k_im, REAL* m_re, REAL* m_im) {
  const REAL f0_re = fk_re + fm_re, f0_im = fk_im - fm_im;
  const REAL f1_re = fk_im + fm_im, f1_im = fm_re - fk_re;
  const REAL g0_re = gk_re + gm_re, g0_im = gk_im - gm_im;
  const REAL g1_re = gk_im + gm_im, g1_im = gm_re - gk_re;
  const REAL p0_re = f0_re * g0_re + f0_im * g0_im, p0_im = f0_re * g0_im - f0_im * g0_re;
  const REAL p1_re = f1_re * g1_re + f1_im * g1_im, p1_im = f1_re * g1_im - f1_im * g1_re;
  *k_re = p0_re - p1_im;
  *k_im = p0_im + p1_re;
  *m_re = p0_re + p1_im;
  *m_im = p1_re - p0_im;
}

#if VECTOR == 1 && BLOCKS == 1
// The two work-items with a packed row lay its spectra down, and all work-items multiply them, a
// frequency and its negative each: spectra of A's row, of B's, then their product likewise.
#define PACKED (4 * 2 * FFT_PX) /* floats */

INLINE void put_packed(const REAL* re, const REAL* im, __local float* packed, const int second,
                       const int y) {
  if (y % HALF_PX != 0) return;
  __local float2* row = (__local float2*)packed + (2 * second + y / HALF_PX) * FFT_PX;
  UNROLL
  for (int k = 0; k < FFT_PX; ++k) row[k] = (float2)(re[k], im[k]);
}

// All work-items of the group must call it, when both spectra have been put; they see the product
// after a barrier.
INLINE void multiply_packed(__local float* packed, const int lane) {
  __local float2* f = (__local float2*)packed + lane / HALF_PX * FFT_PX;
  __local const float2* g = f + 2 * FFT_PX;
  // Frequency 0 is left to row_product.
  const int k = lane % HALF_PX == 0 ? HALF_PX : lane % HALF_PX, m = FFT_PX - k;
  const float2 fk = f[k], fm = f[m], gk = g[k], gm = g[m];
  float2 at_k, at_m;
  packed_product(fk.x, fk.y, fm.x, fm.y, gk.x, gk.y, gm.x, gm.y, (float*)&at_k, (float*)&at_k + 1,
                 (float*)&at_m, (float*)&at_m + 1);
  f[k] = at_k;
  f[m] = at_m;
}

// f* g of rows y …, in fft_back_order. Frequency 0 of rows 0 is left out, which makes the windows
// mean-free.
INLINE void row_product(const REAL* f_re, const REAL* f_im, const REAL* g_re, const REAL* g_im,
                        __local const float* packed, REAL* re, REAL* im, const int y) {
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) {
    const int k = fft_back_order(p, FFT_PX);
    re[p] = f_re[k] * g_re[k] + f_im[k] * g_im[k];
    im[p] = f_re[k] * g_im[k] - f_im[k] * g_re[k];
  }
  if (y % HALF_PX != 0) return;
  __local const float2* row = (__local const float2*)packed + y / HALF_PX * FFT_PX;
  re[0] = 0.0f;
  im[0] = 4.0f * f_im[0] * g_im[0];
  UNROLL
  for (int p = 1; p < FFT_PX; ++p) {
    const float2 product = row[fft_back_order(p, FFT_PX)];
    re[p] = product.x;
    im[p] = product.y;
  }
}
#else
INLINE void row_product(const REAL* f_re, const REAL* f_im, const REAL* g_re, const REAL* g_im,
                        REAL* re, REAL* im, const int y) {
  const INTEGER packed = (y + COLUMN_NUMBERS) % HALF_PX == 0;
  const REAL both = f_re[0] * g_re[0] + f_im[0] * g_im[0];
  const REAL middle = f_re[HALF_PX] * g_re[HALF_PX] + f_im[HALF_PX] * g_im[HALF_PX];
  re[0] = packed ? (REAL)(0.0f) : both;
  im[0] = packed ? 4.0f * f_im[0] * g_im[0] : f_re[0] * g_im[0] - f_im[0] * g_re[0];
  re[1] = packed ? 4.0f * f_re[HALF_PX] * g_re[HALF_PX] : middle;
  im[1] = packed ? 4.0f * f_im[HALF_PX] * g_im[HALF_PX]
                 : f_re[HALF_PX] * g_im[HALF_PX] - f_im[HALF_PX] * g_re[HALF_PX];
  UNROLL
  for (int k = 1; k < HALF_PX; ++k) {
    const int m = FFT_PX - k, at_k = fft_order(m, FFT_PX), at_m = fft_order(k, FFT_PX);
    REAL k_re, k_im, m_re, m_im;
    packed_product(f_re[k], f_im[k], f_re[m], f_im[m], g_re[k], g_im[k], g_re[m], g_im[m], &k_re,
                   &k_im, &m_re, &m_im);
    re[at_k] = packed ? k_re : f_re[k] * g_re[k] + f_im[k] * g_im[k];
    im[at_k] = packed ? k_im : f_re[k] * g_im[k] - f_im[k] * g_re[k];
    re[at_m] = packed ? m_re : f_re[m] * g_re[m] + f_im[m] * g_im[m];
    im[at_m] = packed ? m_im : f_re[m] * g_im[m] - f_im[m] * g_re[m];
  }
}
#endif

// Writes rows y … that are transformed back for get_merged.
INLINE void put_rows(const REAL* re, const REAL* im, __local float* plane, const int y) {
  UNROLL
  for (int x = 0; x < FFT_PX; ++x) PUT(plane, y, x, re[x], im[x]);
}

// Transforms rows y …, in fft_back_order, back and writes them.
INLINE void put_rows_back(REAL* re, REAL* im, __local float* plane, const int y) {
  fft_forward(re, im, FFT_PX);
  put_rows(re, im, plane, y);
}

// Columns x … of what put_rows wrote, A + i B in fft_back_order.
INLINE void get_merged(REAL* re, REAL* im, __local const float* plane, const int x) {
  REAL a_re, a_im, b_re, b_im;
  GET_ACROSS(plane, 0, x, a_re, a_im);
  GET_ACROSS(plane, HALF_PX, x, b_re, b_im);
  re[0] = a_re;
  im[0] = b_re;
  re[1] = a_im;
  im[1] = b_im;
  UNROLL
  for (int k = 1; k < HALF_PX; ++k) {
    const int p = fft_order(FFT_PX - k, FFT_PX), m = fft_order(k, FFT_PX);
    GET_ACROSS(plane, k, x, a_re, a_im);
    GET_ACROSS(plane, HALF_PX + k, x, b_re, b_im);
    re[p] = a_re - b_im;
    im[p] = a_im + b_re;
    re[m] = a_re + b_im;
    im[m] = b_re - a_im;
  }
}

// Columns x … of the correlation, times PAIR_SCALE, in order: re is A's, im B's.
INLINE void get_correlated_columns(REAL* re, REAL* im, __local const float* plane, const int x) {
  get_merged(re, im, plane, x);
  fft_forward(re, im, FFT_PX);
}

#endif  // IMPACTDIC_KERNELS_PAIR_H_
