// Equal windows of 8-bit pixels: their circular cross-correlation without transforms. A row of the
// first window at every lag is a circulant matrix, with which the rows of the second window are
// multiplied: products of matrices of bytes, for which NVIDIA's devices have units (MATRIX_UNITS).
// Elsewhere the same sums are made one by one. Everything is in whole numbers but for the share of
// the means, which is the same at every lag. A group of 32 work-items a window; FFT_PX = 32.
#include "kernels/config.h"
#include "kernels/equal/equal.h"
#include "kernels/zncc/bytes.h"

#define SIDE FFT_PX
#define WORDS (SIDE / 4)
// The second window's rows, the first eight once more behind them; four words more a row: the
// work-items of a warp then find their words in different banks.
#define PITCH_G (WORDS + 4)
#define ROWS_G (SIDE + 8)
// The first window's rows, with words of the other end on both sides.
// The first window's rows shifted by no, one, two and three bytes, each with the words of the other
// end on both sides; before that, an odd number of words apart, as they are.
#define COPY_WORDS 13
#define PITCH_COPIES (4 * COPY_WORDS + 1)
#define PITCH_F (WORDS + 1)
#define PITCH_MAP (SIDE + 8)
#define STORE_WORDS (ROWS_G * PITCH_G + SIDE * PITCH_COPIES)
#define MAP_WORDS (SIDE * PITCH_MAP)
#define HELD (SIDE * SIDE / LANES)

enum { SUM_F, SUM_G, SQUARES_F, SQUARES_G, TOTALS };

// Both windows into local memory; adds to their totals.
INLINE void put_windows(__global const uchar* first, __global const uchar* second, const int width,
                        __local uint* f, __local uint* g, __local int* totals, const int lane) {
  const uint ones = 0x01010101u;
  const int begin = lane / WORDS * ROW + 4 * (lane % WORDS);
  const Pixels of_f = pixels_from(first + begin), of_g = pixels_from(second + begin);
  int own[TOTALS] = {0, 0, 0, 0};
  UNROLL
  for (int i = 0; i < SIDE * WORDS; i += LANES) {
    const int y = i / WORDS + lane / WORDS, x = lane % WORDS;
    const uint a = four_pixels(of_f, width, i / WORDS);
    const uint b = four_pixels(of_g, width, i / WORDS);
    f[y * PITCH_F + x] = a;
    g[y * PITCH_G + x] = b;
    if (i < (ROWS_G - SIDE) * WORDS) g[(y + SIDE) * PITCH_G + x] = b;
    own[SUM_F] = add_dot(a, ones, own[SUM_F]);
    own[SUM_G] = add_dot(b, ones, own[SUM_G]);
    own[SQUARES_F] = add_dot(a, a, own[SQUARES_F]);
    own[SQUARES_G] = add_dot(b, b, own[SQUARES_G]);
  }
  UNROLL
  for (int i = 0; i < TOTALS; ++i) atomic_add(&totals[i], own[i]);
}

#ifdef MATRIX_UNITS
// A work-item holds the four values of its fragment of every 16 columns and 8 rows of lags.
INLINE int held_row(const int k, const int lane) {
  return 8 * (k / 4 % 4) + 2 * (lane % 4) + k % 2;
}

INLINE int held_column(const int k, const int lane) {
  return 16 * (k / 16) + 8 * (k / 2 % 2) + lane / 4;
}

// Number of the i-th value from left to right, and down in a column.
INLINE int held_number(const int i) {
  return 16 * (i / 16) + 4 * (i / 2 % 4) + 2 * (i / 8 % 2) + i % 2;
}

// The first window's rows, shifted, in their place; passes a barrier.
INLINE void put_copies(__local uint* f, const int lane) {
  uint words[WORDS];
  UNROLL
  for (int k = 0; k < WORDS; ++k) words[k] = f[lane * PITCH_F + k];
  GROUP_BARRIER;
  UNROLL
  for (int shift = 0; shift < 4; ++shift) {
    __local uint* copy = f + lane * PITCH_COPIES + shift * COPY_WORDS;
    UNROLL
    for (int k = -1; k < WORDS + 2; ++k) {
      const uint here = words[(k + WORDS) % WORDS], before = words[(k + WORDS - 1) % WORDS];
      copy[k + 1] = (uint)(upsample(here, before) >> (32 - 8 * shift));
    }
  }
}

// Σ f g at the lags that the work-items hold. The group is one warp; passes barriers.
INLINE void correlate(__local uint* f, __local const uint* g, int* held, const int lane) {
  put_copies(f, lane);
  GROUP_BARRIER;
  const int row = lane / 4;
  __local const uint* own_f = f + row % 4 * COPY_WORDS + 1 + lane % 4 - row / 4;
  __local const uint* own_g = g + block_row(lane, PITCH_G);
  UNROLL
  for (int k = 0; k < HELD; ++k) held[k] = 0;
#pragma unroll 1
  for (int y = 0; y < 8; ++y) {
    const uint4 above = four_blocks(own_g + y * PITCH_G);
    const uint4 below = four_blocks(own_g + (y + 16) * PITCH_G);
    const uint2 rows[4] = {above.lo, above.hi, below.lo, below.hi};
    UNROLL
    for (int s = 0; s < 4; ++s) {
      __local const uint* taps = own_f + (y + 8 * s) * PITCH_COPIES;
      // 16 lags of the row; 16 more are the same with the halves of the other rows changed.
      const uint4 lags = (uint4)(taps[0], taps[6], taps[4], taps[2]);
      UNROLL
      for (int n = 0; n < 4; ++n) {
        multiply_32(held + 4 * n, lags, rows[(s + n) % 4]);
        multiply_32(held + 16 + 4 * n, lags, rows[(s + n) % 4].yx);
      }
    }
  }
}
#else
INLINE int held_row(const int k, const int lane) { return (k * LANES + lane) / SIDE; }

INLINE int held_column(const int k, const int lane) { return (k * LANES + lane) % SIDE; }

INLINE int held_number(const int i) { return i; }

INLINE void correlate(__local uint* f, __local const uint* g, int* held, const int lane) {
  __local const char* first = (__local const char*)f;
  for (int k = 0; k < HELD; ++k) {
    const int column = held_column(k, lane);
    held[k] = 0;
    for (int y = 0; y < SIDE; ++y) {
      __local const char* second =
          (__local const char*)(g + (y + held_row(k, lane)) % SIDE * PITCH_G);
      for (int x = 0; x < SIDE; ++x) {
        held[k] += first[y * 4 * PITCH_F + x] * second[(x + column) % SIDE];
      }
    }
  }
}
#endif

// Highest of the map and where it stands: of equal ones the leftmost, of those the topmost.
typedef struct Found {
  int most, at;
} Found;

// The map into local memory, column by column, over what it was made of; passes barriers.
INLINE void put_map(const int* held, __local int* map, __local Found* found, const int lane) {
  int most = held[0];
  UNROLL
  for (int k = 1; k < HELD; ++k) most = max(most, held[k]);
  atomic_max(&found->most, most);
  UNROLL
  for (int k = 0; k < HELD; ++k) {
    map[held_column(k, lane) * PITCH_MAP + held_row(k, lane)] = held[k];
  }
  GROUP_BARRIER;
  if (most == found->most) {
    int at = 0;
    UNROLL
    for (int i = HELD - 1; i >= 0; --i) {
      if (held[held_number(i)] == most) at = held_number(i);
    }
    atomic_min(&found->at, held_column(at, lane) * SIDE + held_row(at, lane));
  }
  GROUP_BARRIER;
}

// pixels, windows, peaks: as equal_windows (equal.cl). A group of LANES a window.
__kernel GROUP_SIZE void equal_bytes(__global const uchar* pixels, const int width,
                                     const int height, __global const Window* windows,
                                     __global EqualPeak* peaks) {
  __local uint store[STORE_WORDS > MAP_WORDS ? STORE_WORDS : MAP_WORDS]
      __attribute__((aligned(16)));
  __local uint* f = store + ROWS_G * PITCH_G;
  __local int* map = (__local int*)store;  // later
  __local Found found[1];
  __local int totals[TOTALS];
  const int lane = (int)get_local_id(0);
  const uint at = (uint)get_group_id(0);
  const Place place = place_of(windows[at], width, height);
  for (int i = lane; i < TOTALS; i += LANES) totals[i] = 0;
  if (lane == 0) {
    found[0].most = INT_MIN;
    found[0].at = SIDE * SIDE;
  }
  GROUP_BARRIER;
  put_windows(pixels + place.first, pixels + place.second, width, f, store, totals, lane);
  GROUP_BARRIER;
  int held[HELD];
  correlate(f, store, held, lane);
  GROUP_BARRIER;
  put_map(held, map, found, lane);
  // Of all values the share of the means, a whole number and parts of SIDE².
  const long share = (long)totals[SUM_F] * totals[SUM_G];
  const int whole = (int)(share >> 10);
  const float rest = (float)((int)share & 1023);
  const int peak_x = found[0].at / SIDE, peak_y = found[0].at % SIDE;
  if (lane < CROSS) {
    const int x = (peak_x + SIDE + (lane == 2) - (lane == 1)) % SIDE;
    const int y = (peak_y + SIDE + (lane == 4) - (lane == 3)) % SIDE;
    peaks[at].cross[lane] = (float)(map[x * PITCH_MAP + y] - whole) * PIXELS - rest;
  }
  if (lane < 2) {
    const long sum = totals[SUM_F + lane], squares = totals[SQUARES_F + lane];
    peaks[at].energy[lane] = (float)(squares * (SIDE * SIDE) - sum * sum) * (1.0f / PIXELS);
    (&peaks[at].x)[lane] = lane ? peak_y : peak_x;
  }
}
