// Complex transforms of 16, 32 and 64 points held in registers: decimation in time in place (Cooley
// and Tukey 1965). A butterfly a ± w b is six multiply-adds: with w = c(1 −
// i s/c) the bracket times b takes two, and c times it is added and subtracted (Linzer and Feig
// 1993); near 90° c and s change places, so that the ratio never passes 1.
//
// REAL is float, or a vector of floats that are as many independent transforms. All loops unroll,
// so that the arrays stay in registers and the twiddles become constants.
#ifndef IMPACTDIC_KERNELS_FFT_H_
#define IMPACTDIC_KERNELS_FFT_H_

#include "kernels/lanes.h"

// Vectors do not fit into a CPU's registers anyway: one copy of the transform is enough there.
#if VECTOR == 1
#define FFT_FUNCTION INLINE
#else
#define FFT_FUNCTION static inline __attribute__((noinline))
#endif

// Of w = exp(−2πi k/64), k = 0 … 31: the larger of |cos| and |sin|, signed, and the other over it.
__constant float fft_factor[32] = {
    1.000000000f,  0.995184727f,  0.980785280f,  0.956940336f,  0.923879533f,  0.881921264f,
    0.831469612f,  0.773010453f,  0.707106781f,  0.773010453f,  0.831469612f,  0.881921264f,
    0.923879533f,  0.956940336f,  0.980785280f,  0.995184727f,  1.000000000f,  0.995184727f,
    0.980785280f,  0.956940336f,  0.923879533f,  0.881921264f,  0.831469612f,  0.773010453f,
    -0.707106781f, -0.773010453f, -0.831469612f, -0.881921264f, -0.923879533f, -0.956940336f,
    -0.980785280f, -0.995184727f};
__constant float fft_ratio[32] = {
    0.000000000f,  0.098491403f,  0.198912367f,  0.303346684f,  0.414213562f,  0.534511136f,
    0.668178638f,  0.820678791f,  1.000000000f,  0.820678791f,  0.668178638f,  0.534511136f,
    0.414213562f,  0.303346684f,  0.198912367f,  0.098491403f,  0.000000000f,  -0.098491403f,
    -0.198912367f, -0.303346684f, -0.414213562f, -0.534511136f, -0.668178638f, -0.820678791f,
    -1.000000000f, -0.820678791f, -0.668178638f, -0.534511136f, -0.414213562f, -0.303346684f,
    -0.198912367f, -0.098491403f};

// (a, b) becomes (a + w b, a − w b) with w = exp(−2πi k/64).
INLINE void fft_butterfly(REAL* re, REAL* im, const int a, const int b, const int k) {
  const REAL a_re = re[a], a_im = im[a], b_re = re[b], b_im = im[b];
  if (k == 0) {
    re[a] = a_re + b_re;
    im[a] = a_im + b_im;
    re[b] = a_re - b_re;
    im[b] = a_im - b_im;
  } else if (k == 16) {
    re[a] = a_re + b_im;
    im[a] = a_im - b_re;
    re[b] = a_re - b_im;
    im[b] = a_im + b_re;
  } else {
    const int is_flat = k <= 8 || k >= 24;
    const float factor = fft_factor[k], ratio = fft_ratio[k];
    const REAL w_re = is_flat ? b_re + ratio * b_im : b_im + ratio * b_re;
    const REAL w_im = is_flat ? b_im - ratio * b_re : ratio * b_im - b_re;
    re[a] = a_re + factor * w_re;
    im[a] = a_im + factor * w_im;
    re[b] = a_re - factor * w_re;
    im[b] = a_im - factor * w_im;
  }
}

// The six bits of 0 … 63 in reverse order.
__constant uchar fft_reversed[64] = {0, 32, 16, 48, 8,  40, 24, 56, 4, 36, 20, 52, 12, 44, 28, 60,
                                     2, 34, 18, 50, 10, 42, 26, 58, 6, 38, 22, 54, 14, 46, 30, 62,
                                     1, 33, 17, 49, 9,  41, 25, 57, 5, 37, 21, 53, 13, 45, 29, 61,
                                     3, 35, 19, 51, 11, 43, 27, 59, 7, 39, 23, 55, 15, 47, 31, 63};

// Number of the sample that stands at place p, and the other way round.
INLINE int fft_order(const int p, const int points) {
  return fft_reversed[p] >> (points == 16 ? 2 : points == 32 ? 1 : 0);
}

// Number of the frequency that stands at place p of what is transformed back: frequencies k and −k
// have changed places, so that the forward transform is the inverse (times `points`).
INLINE int fft_back_order(const int p, const int points) {
  return (points - fft_order(p, points)) % points;
}

// Transforms of radix · step points out of `radix` transforms of `step` points each, the radix (4
// or 8) points of a group staying in registers meanwhile. least_span: 1, or 2 where neighbours have
// been combined.
INLINE void fft_pass(REAL* re, REAL* im, const int points, const int step, const int radix,
                     const int least_span) {
  _Pragma("unroll") for (int group = 0; group < points / radix; ++group) {
    const int j = group % step, first = (group - j) * radix + j;
    _Pragma("unroll") for (int span = least_span; span < radix; span *= 2) {
      _Pragma("unroll") for (int pair = 0; pair < radix / 2; ++pair) {
        const int i = pair % span, a = first + (2 * (pair - i) + i) * step;
        fft_butterfly(re, im, a, a + span * step, (j + i * step) * (32 / (span * step)));
      }
    }
  }
}

// Forward transform, unscaled. Element p of the input is sample fft_order(p, points); the output is
// in order. The inverse (times `points`) is the same transform of frequencies in fft_back_order, or
// fft_forward(im, re, points).
FFT_FUNCTION void fft_forward(REAL* re, REAL* im, const int points) {
  fft_pass(re, im, points, 1, points == 16 ? 4 : 8, 1);
  if (points == 64) {
    fft_pass(re, im, points, 8, 8, 1);
  } else {
    fft_pass(re, im, points, points / 4, 4, 1);
  }
}

// The same where the upper half of the samples, which are the odd elements, is zero and need not be
// given.
FFT_FUNCTION void fft_forward_padded(REAL* re, REAL* im, const int points) {
  _Pragma("unroll") for (int p = 0; p < points; p += 2) {
    re[p + 1] = re[p];
    im[p + 1] = im[p];
  }
  fft_pass(re, im, points, 1, points == 16 ? 4 : 8, 2);
  if (points == 64) {
    fft_pass(re, im, points, 8, 8, 1);
  } else {
    fft_pass(re, im, points, points / 4, 4, 1);
  }
}

#endif  // IMPACTDIC_KERNELS_FFT_H_
