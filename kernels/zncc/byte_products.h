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

#include "kernels/zncc/bytes.h"
#include "kernels/zncc/task.h"

// Blocks of 16 bytes of the area's rows, two a product; of 8 rows of the window and of the map.
#define AREA_CHUNKS (2 * ((AREA_PX + 31) / 32))
#define TAP_BLOCKS ((WINDOW_PX + 7) / 8)
#define LAG_BLOCKS ((LAGS + 7) / 8)

// Four words more: the work-items of a warp then find their words in different banks.
#define AREA_PITCH (4 * AREA_CHUNKS + 4)
// Blocks of the area that meet one row of the window of every block, an even number.
#define AREA_BLOCKS ((TAP_BLOCKS + LAG_BLOCKS) / 2 * 2)
#define AREA_ROWS (8 * (AREA_BLOCKS + 1))
#define AREA_WORDS (AREA_ROWS * AREA_PITCH)
#define TAP_CHUNKS ((WINDOW_PX + 15) / 16)
#define TAP_MARGIN 4
#define TAP_PITCH (4 * TAP_CHUNKS + 2 * TAP_MARGIN)
#define TAP_ROWS (8 * TAP_BLOCKS)
#define TAP_WORDS (TAP_ROWS * TAP_PITCH)

#ifdef MATRIX_UNITS
// A work-item holds the four values of its fragment of every 16 columns and 8 rows of lags.
#define LAG_TILES ((LAGS + 15) / 16)
#define HELD (4 * LAG_TILES * LAG_BLOCKS)
// Fragments of 8 lags that differ: by so many bytes of the area's row is the window's row shifted
// in the first one, by 8 more in every other; beyond them all is zero.
#define LEAST_SHIFT (-8)
#define SHIFTS ((WINDOW_PX + 6) / 8 + 2)
#define PAIRS ((SHIFTS + 1) / 2)

// Adds the products to what the work-items hold. The group is one warp.
INLINE void add_products(__local const uint* area, __local const uint* window, int* held,
                         const int lane) {
  const int row = lane / 4;
  __local const uint* own_area = area + block_row(lane, AREA_PITCH);
  __local const uint* own_taps = window + TAP_MARGIN + lane % 4 - row / 4;
  const uint bits = 32 - 8 * (row % 4);
#pragma unroll 1
  for (int y = 0; y < 8; ++y) {
    uint2 rows[AREA_BLOCKS][AREA_CHUNKS / 2];
    UNROLL
    for (int j = 0; j < AREA_BLOCKS; j += 2) {
      UNROLL
      for (int c = 0; c < AREA_CHUNKS / 2; ++c) {
        const uint4 blocks = four_blocks(own_area + (y + 8 * j) * AREA_PITCH + 8 * c);
        rows[j][c] = blocks.lo;
        rows[j + 1][c] = blocks.hi;
      }
    }
    UNROLL
    for (int s = 0; s < TAP_BLOCKS; ++s) {
      __local const uint* taps = own_taps + (y + 8 * s) * TAP_PITCH;
      uint shifted[2 * PAIRS];
      UNROLL
      for (int i = 0; i < 2 * PAIRS; ++i) {
        const int at = (LEAST_SHIFT + 8 * i) / 4;
        shifted[i] = i < SHIFTS ? (uint)(upsample(taps[at], taps[at - 1]) >> bits) : 0;
      }
      UNROLL
      for (int tile = 0; tile < LAG_TILES; ++tile) {
        UNROLL
        for (int n = 0; n < LAG_BLOCKS; ++n) {
          int* sums = held + 4 * (tile * LAG_BLOCKS + n);
          const int end = min(AREA_CHUNKS, tile + PAIRS);
          // Chunks by twos: both, one or none of them meets the window's row.
          UNROLL
          for (int c = 0; c < AREA_CHUNKS; c += 2) {
            const uint2 pixels = rows[s + n][c / 2];
            const int i = 2 * (c - tile);
            if (c >= tile && c + 1 < end) {
              multiply_32(sums, (uint4)(shifted[i + 1], shifted[i], shifted[i + 3], shifted[i + 2]),
                          pixels);
            } else if (c >= tile && c < end) {
              multiply_16(sums, (uint2)(shifted[i + 1], shifted[i]), pixels.x);
            } else if (c + 1 == tile) {
              multiply_16(sums, (uint2)(shifted[i + 3], shifted[i + 2]), pixels.y);
            }
          }
        }
      }
    }
  }
}

// Row and column of the map of value k that a work-item holds.
INLINE int held_row(const int k, const int lane) {
  return 8 * (k / 4 % LAG_BLOCKS) + 2 * (lane % 4) + k % 2;
}

INLINE int held_column(const int k, const int lane) {
  return 16 * (k / 4 / LAG_BLOCKS) + 8 * (k / 2 % 2) + lane / 4;
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
