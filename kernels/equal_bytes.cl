// Equal windows of 8-bit pixels: their circular cross-correlation without transforms. A row of the
// first window at every lag is a circulant matrix, with which the rows of the second window are
// multiplied: products of matrices of bytes, for which NVIDIA's devices have units (MATRIX_UNITS).
// Elsewhere the same sums are made one by one. Everything is in whole numbers but for the share of
// the means, which is the same at every lag. A group of 32 work-items a window; FFT_PX = 32.
#include "kernels/config.h"
#include "kernels/bytes.h"
#include "kernels/equal.h"

#define SIDE FFT_PX
#define WORDS (SIDE / 4)
// The second window's rows, the first eight once more behind them; four words more a row: the
// work-items of a warp then find their words in different banks.
#define PITCH_G (WORDS + 4)
#define ROWS_G (SIDE + 8)
// The first window's rows, with words of the other end on both sides.
#define MARGIN 2
#define PITCH_F (WORDS + 2 * MARGIN)
#define PITCH_MAP (SIDE + 8)
#define STORE_WORDS (ROWS_G * PITCH_G + SIDE * PITCH_F)
#define MAP_WORDS (SIDE * PITCH_MAP)
#define HELD (SIDE * SIDE / LANES)

enum { SUM_F, SUM_G, SQUARES_F, SQUARES_G, TOTALS };

// Both windows into local memory; adds to their totals.
INLINE void put_windows(__global const uchar* first, __global const uchar* second, const int width,
                        __local uint* f, __local uint* g, __local int* totals, const int lane) {
  int own[TOTALS] = {0, 0, 0, 0};
  UNROLL
  for (int i = 0; i < 2 * SIDE; i += LANES) {
    const int y = (i + lane) / 2, chunk = (i + lane) % 2;
    const uint4 a = sixteen_pixels(first + y * ROW + 16 * chunk);
    const uint4 b = sixteen_pixels(second + y * ROW + 16 * chunk);
    __local uint* row_f = f + y * PITCH_F;
    *(__local uint2*)(row_f + MARGIN + 4 * chunk) = a.lo;
    *(__local uint2*)(row_f + MARGIN + 4 * chunk + 2) = a.hi;
    *(__local uint2*)(row_f + (chunk ? 0 : MARGIN + WORDS)) = chunk ? a.hi : a.lo;
    *(__local uint4*)(g + y * PITCH_G + 4 * chunk) = b;
    if (y < ROWS_G - SIDE) *(__local uint4*)(g + (y + SIDE) * PITCH_G + 4 * chunk) = b;
    own[SUM_F] += sum_of(a);
    own[SUM_G] += sum_of(b);
    own[SQUARES_F] += dot_of(a, a);
    own[SQUARES_G] += dot_of(b, b);
  }
  UNROLL
  for (int i = 0; i < TOTALS; ++i) atomic_add(&totals[i], own[i]);
}

#ifdef MATRIX_UNITS
// A work-item holds the four values of its fragment of every 16 rows and 8 columns of lags.
INLINE int held_row(const int k, const int lane) {
  return 16 * (k / 16) + 8 * (k / 2 % 2) + lane / 4;
}

INLINE int held_column(const int k, const int lane) {
  return 8 * (k / 4 % 4) + 2 * (lane % 4) + k % 2;
}

// Σ f g at the lags that the work-items hold. The group is one warp.
INLINE void correlate(__local const uint* f, __local const uint* g, int* held, const int lane) {
  const int row = lane / 4, word = lane % 4;
  __local const uint* own_g = g + row * PITCH_G + word;
  __local const uint* own_f = f + MARGIN + word - row / 4;
  const uint bits = 32 - 8 * (row % 4);
  UNROLL
  for (int k = 0; k < HELD; ++k) held[k] = 0;
#pragma unroll 1
  for (int y = 0; y < 8; ++y) {
    uint a[4][2];
    UNROLL
    for (int j = 0; j < 4; ++j) {
      a[j][0] = own_g[(y + 8 * j) * PITCH_G];
      a[j][1] = own_g[(y + 8 * j) * PITCH_G + 4];
    }
    UNROLL
    for (int s = 0; s < 4; ++s) {
      __local const uint* taps = own_f + (y + 8 * s) * PITCH_F;
      uint b[4];
      UNROLL
      for (int i = 0; i < 4; ++i) b[i] = (uint)(upsample(taps[2 * i], taps[2 * i - 1]) >> bits);
      UNROLL
      for (int tile = 0; tile < 2; ++tile) {
        const int j = (s + 2 * tile) % 4, below = (j + 1) % 4;
        UNROLL
        for (int n = 0; n < 4; ++n) {
          multiply_32(held + 16 * tile + 4 * n, a[j][0], a[below][0], a[j][1], a[below][1],
                      b[(4 - n) % 4], b[(6 - n) % 4]);
        }
      }
    }
  }
}
#else
INLINE int held_row(const int k, const int lane) { return (k * LANES + lane) / SIDE; }

INLINE int held_column(const int k, const int lane) { return (k * LANES + lane) % SIDE; }

INLINE void correlate(__local const uint* f, __local const uint* g, int* held, const int lane) {
  __local const char* first = (__local const char*)(f + MARGIN);
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

// The map into local memory, over what it was made of; passes barriers.
INLINE void put_map(const int* held, __local int* map, __local Found* found, const int lane) {
  int most = held[0];
  UNROLL
  for (int k = 1; k < HELD; ++k) most = max(most, held[k]);
  atomic_max(&found->most, most);
  UNROLL
  for (int k = 0; k < HELD; ++k) {
    map[held_row(k, lane) * PITCH_MAP + held_column(k, lane)] = held[k];
  }
  GROUP_BARRIER;
  if (most == found->most) {
    int at = SIDE * SIDE;
    UNROLL
    for (int k = 0; k < HELD; ++k) {
      if (held[k] == most) at = min(at, held_column(k, lane) * SIDE + held_row(k, lane));
    }
    atomic_min(&found->at, at);
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
  const int whole = (int)(share / (SIDE * SIDE));
  const float rest = (float)(int)(share % (SIDE * SIDE));
  const int peak_x = found[0].at / SIDE, peak_y = found[0].at % SIDE;
  for (int arm = lane; arm < CROSS; arm += LANES) {
    const int x = (peak_x + SIDE + (arm == 2) - (arm == 1)) % SIDE;
    const int y = (peak_y + SIDE + (arm == 4) - (arm == 3)) % SIDE;
    peaks[at].cross[arm] = (float)(map[y * PITCH_MAP + x] - whole) * PIXELS - rest;
  }
  for (int picture = lane; picture < 2; picture += LANES) {
    const float energy =
        (float)((long)totals[SQUARES_F + picture] * (SIDE * SIDE) -
                (long)totals[SUM_F + picture] * totals[SUM_F + picture]);
    peaks[at].energy[picture] = energy * (1.0f / PIXELS);
  }
  for (int k = lane; k == 0; k += LANES) {
    peaks[at].x = peak_x;
    peaks[at].y = peak_y;
  }
}
