// Complex transforms of 16, 32 and 64 points held in registers: decimation in frequency in place,
// radix 4 with a last radix 2 where the length asks for it (Cooley and Tukey 1965).
//
// REAL is float, or a vector of floats that are as many independent transforms. The code is a C
// subset that also compiles as C++. UNROLL stands before loops that must unroll so that the arrays
// stay in registers; empty where REAL is a vector, whose arrays lie in memory anyway.
#ifndef IMPACTDIC_KERNELS_FFT_H_
#define IMPACTDIC_KERNELS_FFT_H_

#ifndef REAL
#define REAL float
#endif
#ifndef UNROLL
#define UNROLL
#endif
#ifdef __OPENCL_C_VERSION__
#define FFT_TABLE __constant
#define FFT_INLINE static inline
#else
#define FFT_TABLE static const
#define FFT_INLINE inline
#endif

// cos(2π k / 64), k = 0 … 111; sin(2π k / 64) = cos(2π (k + 48) / 64).
FFT_TABLE float fft_cosine[112] = {
    1.000000000f,  0.995184727f,  0.980785280f,  0.956940336f,  0.923879533f,  0.881921264f,
    0.831469612f,  0.773010453f,  0.707106781f,  0.634393284f,  0.555570233f,  0.471396737f,
    0.382683432f,  0.290284677f,  0.195090322f,  0.098017140f,  0.000000000f,  -0.098017140f,
    -0.195090322f, -0.290284677f, -0.382683432f, -0.471396737f, -0.555570233f, -0.634393284f,
    -0.707106781f, -0.773010453f, -0.831469612f, -0.881921264f, -0.923879533f, -0.956940336f,
    -0.980785280f, -0.995184727f, -1.000000000f, -0.995184727f, -0.980785280f, -0.956940336f,
    -0.923879533f, -0.881921264f, -0.831469612f, -0.773010453f, -0.707106781f, -0.634393284f,
    -0.555570233f, -0.471396737f, -0.382683432f, -0.290284677f, -0.195090322f, -0.098017140f,
    0.000000000f,  0.098017140f,  0.195090322f,  0.290284677f,  0.382683432f,  0.471396737f,
    0.555570233f,  0.634393284f,  0.707106781f,  0.773010453f,  0.831469612f,  0.881921264f,
    0.923879533f,  0.956940336f,  0.980785280f,  0.995184727f,  1.000000000f,  0.995184727f,
    0.980785280f,  0.956940336f,  0.923879533f,  0.881921264f,  0.831469612f,  0.773010453f,
    0.707106781f,  0.634393284f,  0.555570233f,  0.471396737f,  0.382683432f,  0.290284677f,
    0.195090322f,  0.098017140f,  0.000000000f,  -0.098017140f, -0.195090322f, -0.290284677f,
    -0.382683432f, -0.471396737f, -0.555570233f, -0.634393284f, -0.707106781f, -0.773010453f,
    -0.831469612f, -0.881921264f, -0.923879533f, -0.956940336f, -0.980785280f, -0.995184727f,
    -1.000000000f, -0.995184727f, -0.980785280f, -0.956940336f, -0.923879533f, -0.881921264f,
    -0.831469612f, -0.773010453f, -0.707106781f, -0.634393284f, -0.555570233f, -0.471396737f,
    -0.382683432f, -0.290284677f, -0.195090322f, -0.098017140f};

// exp(−2πi k / 64) times (re, im), k = 0 … 63.
#define FFT_TWIDDLE(re, im, k)             \
  {                                        \
    const float c_ = fft_cosine[(k)];      \
    const float s_ = fft_cosine[(k) + 48]; \
    const REAL re_ = (re);                 \
    (re) = re_ * c_ + (im)*s_;             \
    (im) = (im)*c_ - re_ * s_;             \
  }

// One radix-4 pass over transforms of `length` points.
FFT_INLINE void fft_pass4(REAL* re, REAL* im, const int points, const int length) {
  const int q = length / 4;
  UNROLL
  for (int start = 0; start < points; start += length) {
    UNROLL
    for (int j = 0; j < q; ++j) {
      const int a = start + j, b = a + q, c = b + q, d = c + q;
      const REAL sum_re = re[a] + re[c], sum_im = im[a] + im[c];
      const REAL dif_re = re[a] - re[c], dif_im = im[a] - im[c];
      const REAL add_re = re[b] + re[d], add_im = im[b] + im[d];
      const REAL sub_re = re[b] - re[d], sub_im = im[b] - im[d];
      re[a] = sum_re + add_re;
      im[a] = sum_im + add_im;
      re[b] = dif_re + sub_im;
      im[b] = dif_im - sub_re;
      re[c] = sum_re - add_re;
      im[c] = sum_im - add_im;
      re[d] = dif_re - sub_im;
      im[d] = dif_im + sub_re;
      if (j > 0) {
        const int turn = j * (64 / length);
        FFT_TWIDDLE(re[b], im[b], turn);
        FFT_TWIDDLE(re[c], im[c], 2 * turn);
        FFT_TWIDDLE(re[d], im[d], 3 * turn);
      }
    }
  }
}

FFT_INLINE void fft_pass2(REAL* re, REAL* im, const int points) {
  UNROLL
  for (int a = 0; a < points; a += 2) {
    const REAL re_a = re[a], im_a = im[a];
    re[a] = re_a + re[a + 1];
    im[a] = im_a + im[a + 1];
    re[a + 1] = re_a - re[a + 1];
    im[a + 1] = im_a - im[a + 1];
  }
}

// Forward transform, unscaled; element p of the result is the frequency fft_order(p, points).
// The inverse (times `points`) is fft_forward(im, re, points).
FFT_INLINE void fft_forward(REAL* re, REAL* im, const int points) {
  fft_pass4(re, im, points, points);
  if (points == 64) {
    fft_pass4(re, im, points, 16);
    fft_pass4(re, im, points, 4);
  } else if (points == 32) {
    fft_pass4(re, im, points, 8);
    fft_pass2(re, im, points);
  } else {
    fft_pass4(re, im, points, 4);
  }
}

// Digits of p, most significant first, in the reverse order.
FFT_INLINE int fft_order(const int p, const int points) {
  if (points == 16) return (p >> 2) | ((p & 3) << 2);
  if (points == 32) return (p >> 3) | (((p >> 1) & 3) << 2) | ((p & 1) << 4);
  return (p >> 4) | (((p >> 2) & 3) << 2) | ((p & 3) << 4);
}

#endif  // IMPACTDIC_KERNELS_FFT_H_
