// Equal windows: circular cross-correlation of mean-free windows of FFT_PX = 16 or 32, two windows
// a group, everything in one kernel. equal_bytes.cl is the same for 8-bit pictures on some devices,
// equal_motions.cl what becomes of the peaks.
#include "kernels/config.h"
#include "kernels/equal/equal.h"
#include "kernels/zncc/pair.h"

#if VECTOR == 1
#define PIXELS_AT(p) ((float)*(p))
#else
#define PIXELS_AT(p) PASTE(convert_float, VECTOR)(LOAD(p))
#endif

// Columns x … of two windows, in fft_order. The pixels need not be mean-free: sums of integers are
// exact.
INLINE void get_windows(REAL* re, REAL* im, __global const PIXEL* a, __global const PIXEL* b,
                        const int width, const int x) {
  UNROLL
  for (int p = 0; p < FFT_PX; ++p) {
    const int at = fft_order(p, FFT_PX) * ROW + x;
    re[p] = PIXELS_AT(a + at);
    im[p] = PIXELS_AT(b + at);
  }
}

// What the rows y … give to a window's energy, times 2 · PIXELS, by Parseval's theorem; without the
// mean, which is frequency 0 of rows 0.
INLINE REAL row_energy(const REAL* re, const REAL* im, const int y) {
  const INTEGER packed = (y + COLUMN_NUMBERS) % HALF_PX == 0;
  const REAL mean = packed ? (REAL)(0.0f) : re[0];
  REAL sum = mean * mean + im[0] * im[0];
  UNROLL
  for (int k = 1; k < FFT_PX; ++k) sum += re[k] * re[k] + im[k] * im[k];
  return packed ? 2.0f * sum : sum;
}

// Columns x … of the correlation, re: of A, im: of B, into a plane, and their highest values.
INLINE void put_correlation(const REAL* re, const REAL* im, __local float* plane,
                            __local float* highest, const int x) {
  REAL most_a = re[0], most_b = im[0];
  UNROLL
  for (int y = 0; y < FFT_PX; ++y) {
    PUT(plane, x, y, re[y], im[y]);
    most_a = fmax(most_a, re[y]);
    most_b = fmax(most_b, im[y]);
  }
  PUT_VALUES(most_a, highest + x);
  PUT_VALUES(most_b, highest + FFT_PX + x);
}

#if VECTOR == 1 && BLOCKS == 1
#define SCRATCH PACKED

// Row `lane` of the spectra of two windows, its energy, and the packed rows: number `second` of
// those that are multiplied. Passes barriers; the plane is free when it returns.
INLINE void transform_windows(__global const PIXEL* a, __global const PIXEL* b, const int width,
                              __local float* plane, __local float* packed, __local float* energies,
                              const int second, const int lane, float* re, float* im) {
  get_windows(re, im, a, b, width, lane);
  put_column_spectra(re, im, plane, lane);
  GROUP_BARRIER;
  get_row_spectra(re, im, plane, lane);
  put_packed(re, im, packed, second, lane);
  energies[second * FFT_PX + lane] = row_energy(re, im, lane);
  GROUP_BARRIER;
}

// The correlation of two pairs of windows, whose spectra are f and g, into the plane, times
// PAIR_SCALE: part 0 for A, part 1 for B. highest: the highest value of each column. Passes
// barriers.
INLINE void correlate_rows(const float* f_re, const float* f_im, const float* g_re,
                           const float* g_im, __local float* plane, __local float* packed,
                           __local float* highest, const int lane) {
  float re[FFT_PX], im[FFT_PX];
  multiply_packed(packed, lane);
  GROUP_BARRIER;
  row_product(f_re, f_im, g_re, g_im, packed, re, im, lane);
  put_rows_back(re, im, plane, lane);
  GROUP_BARRIER;
  get_correlated_columns(re, im, plane, lane);
  GROUP_BARRIER;
  put_correlation(re, im, plane, highest, lane);
  GROUP_BARRIER;
}

// What was worked out from the second windows becomes that of the first.
INLINE void move_on(__local float* packed, __local float* energies, const int lane) {
  for (int k = lane; k < PACKED / 2; k += LANES) packed[k] = packed[PACKED / 2 + k];
  energies[lane] = energies[FFT_PX + lane];
}
#else
#define SCRATCH (2 * PLANE)
INLINE void put_windows(__global const PIXEL* a, __global const PIXEL* b, const int width,
                        __local float* plane, const int lane) {
  for (int block = 0; block < BLOCKS; ++block) {
    REAL re[FFT_PX], im[FFT_PX];
    get_windows(re, im, a, b, width, COLUMN(block));
    put_column_spectra(re, im, plane, COLUMN(block));
  }
}

// The correlation of two pairs of windows as above. energies: of the rows of A, then of B, in the
// first picture, then the same in the second. scratch: a plane.
INLINE void correlate_pair(__global const PIXEL* pixels, const Place a, const Place b,
                           const int width, __local float* plane, __local float* scratch,
                           __local float* energies, __local float* highest, const int lane) {
  REAL f_re[FFT_PX], f_im[FFT_PX], g_re[FFT_PX], g_im[FFT_PX], re[FFT_PX], im[FFT_PX];
  put_windows(pixels + a.first, pixels + b.first, width, plane, lane);
  GROUP_BARRIER;
  for (int block = 0; block < BLOCKS; ++block) {
    const int y = COLUMN(block);
    get_row_spectra(f_re, f_im, plane, y);
    PUT_VALUES(row_energy(f_re, f_im, y), energies + y);
    for (int k = 0; k < FFT_PX; ++k) PUT(scratch, y, k, f_re[k], f_im[k]);
  }
  GROUP_BARRIER;
  put_windows(pixels + a.second, pixels + b.second, width, plane, lane);
  GROUP_BARRIER;
  for (int block = 0; block < BLOCKS; ++block) {
    const int y = COLUMN(block);
    get_row_spectra(g_re, g_im, plane, y);
    PUT_VALUES(row_energy(g_re, g_im, y), energies + FFT_PX + y);
    for (int k = 0; k < FFT_PX; ++k) GET(scratch, y, k, f_re[k], f_im[k]);
    row_product(f_re, f_im, g_re, g_im, re, im, y);
    put_rows_back(re, im, scratch, y);
  }
  GROUP_BARRIER;
  for (int block = 0; block < BLOCKS; ++block) {
    const int x = COLUMN(block);
    get_correlated_columns(re, im, scratch, x);
    put_correlation(re, im, plane, highest, x);
  }
  GROUP_BARRIER;
}
#endif

// Where the highest value of both windows of a pair stands: of equal ones the leftmost, of those
// the topmost.
typedef struct Found {
  int most, x, y;
} Found;

// All work-items of the group call it; passes barriers, and `found` may be read when it returns.
INLINE void find_peaks(__local const float* plane, __local const float* highest,
                       __local Found* found, const int lane) {
  for (int x = lane; x < FFT_PX; x += LANES) {
    UNROLL
    for (int which = 0; which < 2; ++which) {
      atomic_max(&found[which].most, in_order(highest[which * FFT_PX + x]));
    }
  }
  GROUP_BARRIER;
  for (int x = lane; x < FFT_PX; x += LANES) {
    UNROLL
    for (int which = 0; which < 2; ++which) {
      if (in_order(highest[which * FFT_PX + x]) == found[which].most) {
        atomic_min(&found[which].x, x);
      }
    }
  }
  GROUP_BARRIER;
  for (int y = lane; y < FFT_PX; y += LANES) {
    UNROLL
    for (int which = 0; which < 2; ++which) {
      if (in_order(AT(plane, which, found[which].x, y)) == found[which].most) {
        atomic_min(&found[which].y, y);
      }
    }
  }
  GROUP_BARRIER;
}

// energies: of the rows of A, then of B, in the first picture, then the same in the second.
INLINE void write_peaks(__local const float* plane, __local const float* energies,
                        __local const Found* found, const uint at, const uint count, const int lane,
                        __global EqualPeak* peaks) {
  for (int k = lane; k < 2 * CROSS; k += LANES) {
    const int which = k / CROSS, arm = k % CROSS;
    if (at + which >= count) continue;
    const int x = (found[which].x + FFT_PX + (arm == 2) - (arm == 1)) % FFT_PX;
    const int y = (found[which].y + FFT_PX + (arm == 4) - (arm == 3)) % FFT_PX;
    peaks[at + which].cross[arm] = AT(plane, which, x, y) * (PIXELS / PAIR_SCALE);
    if (arm == 0) {
      peaks[at + which].x = x;
      peaks[at + which].y = y;
    }
  }
  for (int k = lane; k < 4; k += LANES) {
    const int which = k % 2, picture = k / 2;
    if (at + which >= count) continue;
    float4 sum = vload4(0, energies + k * HALF_PX);
    for (int row = 1; row < HALF_PX / 4; ++row) sum += vload4(row, energies + k * HALF_PX);
    peaks[at + which].energy[picture] = ((sum.x + sum.y) + (sum.z + sum.w)) * (0.5f / PIXELS);
  }
}

// pixels: (slots, height, width), each slot a picture; windows: (count); peaks: (count) written. A
// group of LANES measures windows i and i + 1, then i + period and i + period + 1, and so on, CHAIN
// times: where the second picture's windows are the first's of the next, as in the frames of a
// clip, they are transformed once. FFT_PX ≤ width, height; a batch's pixels are at most 2³¹.
__kernel GROUP_SIZE void equal_windows(__global const PIXEL* pixels, const int width,
                                       const int height, __global const Window* windows,
                                       const uint count, const uint period,
                                       __global EqualPeak* peaks) {
  __local float plane[2 * PLANE] __attribute__((aligned(16)));
  __local float scratch[SCRATCH] __attribute__((aligned(16)));
  __local float highest[2 * FFT_PX] __attribute__((aligned(16)));
  __local float energies[2 * FFT_PX] __attribute__((aligned(16)));
  __local Found found[2];
  const int lane = (int)get_local_id(0);
  const uint groups = (period + 1) / 2, group = (uint)get_group_id(0);
  const uint i = 2 * (group % groups), begin = group / groups * CHAIN * period + i;
#if VECTOR == 1 && BLOCKS == 1
  float f_re[FFT_PX], f_im[FFT_PX], g_re[FFT_PX], g_im[FFT_PX];
  int before_a = -1, before_b = -1;
#endif
#pragma unroll 1
  for (uint k = 0; k < CHAIN && begin + k * period < count; ++k) {
    const uint at = begin + k * period;
    const uint end = min(count, at - i + period);
    const Place a = place_of(windows[at], width, height);
    const Place b = place_of(windows[min(at + 1, end - 1)], width, height);
    for (int which = lane; which < 2; which += LANES) {
      found[which].most = INT_MIN;
      found[which].x = found[which].y = FFT_PX;
    }
#if VECTOR == 1 && BLOCKS == 1
    if (a.first == before_a && b.first == before_b) {
      UNROLL
      for (int p = 0; p < FFT_PX; ++p) {
        f_re[p] = g_re[p];
        f_im[p] = g_im[p];
      }
      move_on(scratch, energies, lane);
    } else {
      transform_windows(pixels + a.first, pixels + b.first, width, plane, scratch, energies, 0,
                        lane, f_re, f_im);
    }
    transform_windows(pixels + a.second, pixels + b.second, width, plane, scratch, energies, 1,
                      lane, g_re, g_im);
    correlate_rows(f_re, f_im, g_re, g_im, plane, scratch, highest, lane);
    before_a = a.second;
    before_b = b.second;
#else
    correlate_pair(pixels, a, b, width, plane, scratch, energies, highest, lane);
#endif
    find_peaks(plane, highest, found, lane);
    write_peaks(plane, energies, found, at, end, lane, peaks);
    GROUP_BARRIER;
  }
}
