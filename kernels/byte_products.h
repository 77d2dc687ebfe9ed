// Σ t(x, y) g(x + i, y + j), the products of a window of signed bytes with a larger area at every
// lag (i, j), exactly. A row t(·, y) at all lags i is a Toeplitz matrix, with which the area's rows
// y … are multiplied: products of matrices of bytes, for which NVIDIA's devices have units
// (MATRIX_UNITS; fragments as PTX's mma.m16n8k32 and m16n8k16 lay them out). Elsewhere the same
// sums are made one by one.
//
// Area: rows of AREA_PITCH words, four bytes each, from column 0 on; AREA_ROWS of them, of which
// those from AREA_PX on may hold anything. Window: rows of TAP_PITCH words, of which TAP_MARGIN on
// the left and those behind the window are zero; TAP_ROWS of them, zero from WINDOW_PX on.
#ifndef IMPACTDIC_KERNELS_BYTE_PRODUCTS_H_
#define IMPACTDIC_KERNELS_BYTE_PRODUCTS_H_

#include "kernels/bytes.h"
#include "kernels/task.h"

// Blocks of 16 bytes of the area's rows, two a product; of 8 rows of the window and of the map.
#define AREA_CHUNKS (2 * ((AREA_PX + 31) / 32))
#define TAP_BLOCKS ((WINDOW_PX + 7) / 8)
#define LAG_BLOCKS ((LAGS + 7) / 8)

// Four words more: the work-items of a warp then find their words in different banks.
#define AREA_PITCH (4 * AREA_CHUNKS + 4)
#define AREA_ROWS (8 * (TAP_BLOCKS + LAG_BLOCKS))
#define AREA_WORDS (AREA_ROWS * AREA_PITCH)
#define TAP_CHUNKS ((WINDOW_PX + 15) / 16)
#define TAP_MARGIN 4
#define TAP_PITCH (4 * TAP_CHUNKS + 2 * TAP_MARGIN)
#define TAP_ROWS (8 * TAP_BLOCKS)
#define TAP_WORDS (TAP_ROWS * TAP_PITCH)

#ifdef MATRIX_UNITS
// A work-item holds the four values of its fragment of every 16 rows and 8 columns of lags.
#define LAG_TILES ((LAGS + 15) / 16)
#define HELD (4 * LAG_TILES * LAG_BLOCKS)
// Bytes of the area's row by which the window's row is shifted in a fragment; beyond these the
// fragment is zero.
#define LEAST_SHIFT (-8)
#define MOST_SHIFT ((WINDOW_PX + 6) / 8 * 8)
#define SHIFTS ((MOST_SHIFT - LEAST_SHIFT) / 8 + 1)

// Adds the products to what the work-items hold. The group is one warp.
INLINE void add_products(__local const uint* area, __local const uint* window, int* held,
                         const int lane) {
  const int row = lane / 4, word = lane % 4;
  __local const uint* own_area = area + row * AREA_PITCH + word;
  __local const uint* own_taps = window + TAP_MARGIN + word - row / 4;
  const uint bits = 32 - 8 * (row % 4);
#pragma unroll 1
  for (int y = 0; y < 8; ++y) {
    uint a[TAP_BLOCKS + LAG_BLOCKS - 1][AREA_CHUNKS];
    UNROLL
    for (int j = 0; j < TAP_BLOCKS + LAG_BLOCKS - 1; ++j) {
      UNROLL
      for (int c = 0; c < AREA_CHUNKS; ++c) a[j][c] = own_area[(y + 8 * j) * AREA_PITCH + 4 * c];
    }
    UNROLL
    for (int s = 0; s < TAP_BLOCKS; ++s) {
      __local const uint* taps = own_taps + (y + 8 * s) * TAP_PITCH;
      uint b[SHIFTS];
      UNROLL
      for (int i = 0; i < SHIFTS; ++i) {
        const int at = (LEAST_SHIFT + 8 * i) / 4;
        b[i] = (uint)(upsample(taps[at], taps[at - 1]) >> bits);
      }
      UNROLL
      for (int tile = 0; tile < LAG_TILES; ++tile) {
        const int j = s + 2 * tile, below = 2 * tile + 1 < LAG_BLOCKS ? j + 1 : j;
        UNROLL
        for (int n = 0; n < LAG_BLOCKS; ++n) {
          int* sums = held + 4 * (tile * LAG_BLOCKS + n);
          const int last = min(AREA_CHUNKS - 1, (MOST_SHIFT + 8 * n) / 16);
          UNROLL
          for (int c = n / 2; c <= last; c += 2) {
            const int i = (16 * c - 8 * n - LEAST_SHIFT) / 8;
            if (c < last) {
              multiply_32(sums, a[j][c], a[below][c], a[j][c + 1], a[below][c + 1], b[i], b[i + 2]);
            } else {
              multiply_16(sums, a[j][c], a[below][c], b[i]);
            }
          }
        }
      }
    }
  }
}

// Row and column of the map of value k that a work-item holds.
INLINE int held_row(const int k, const int lane) {
  return 16 * (k / 4 / LAG_BLOCKS) + 8 * (k / 2 % 2) + lane / 4;
}

INLINE int held_column(const int k, const int lane) {
  return 8 * (k / 4 % LAG_BLOCKS) + 2 * (lane % 4) + k % 2;
}
#else
#define HELD ((LAGS * LAGS + LANES - 1) / LANES)

INLINE int held_row(const int k, const int lane) { return (k * LANES + lane) / LAGS; }

INLINE int held_column(const int k, const int lane) { return (k * LANES + lane) % LAGS; }

INLINE void add_products(__local const uint* area, __local const uint* window, int* held,
                         const int lane) {
  __local const char* taps = (__local const char*)(window + TAP_MARGIN);
  for (int k = 0; k < HELD; ++k) {
    const int row = min(held_row(k, lane), LAGS - 1);
    __local const char* at =
        (__local const char*)area + row * 4 * AREA_PITCH + held_column(k, lane);
    for (int y = 0; y < WINDOW_PX; ++y) {
      for (int x = 0; x < WINDOW_PX; ++x) {
        held[k] += taps[y * 4 * TAP_PITCH + x] * at[y * 4 * AREA_PITCH + x];
      }
    }
  }
}
#endif

INLINE void put_products(const int* held, __local int* map, const int lane) {
  UNROLL
  for (int k = 0; k < HELD; ++k) {
    const int row = held_row(k, lane), column = held_column(k, lane);
    if (row < LAGS && column < LAGS) map[row * LAGS + column] = held[k];
  }
}

#endif  // IMPACTDIC_KERNELS_BYTE_PRODUCTS_H_
