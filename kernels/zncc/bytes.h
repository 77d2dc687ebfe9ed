// Pixels of 8 bits as signed bytes about their middle, four in a word, and what multiplies them:
// with MATRIX_UNITS that of NVIDIA's devices (PTX's mma and dp4a), elsewhere plain C.
#ifndef IMPACTDIC_KERNELS_BYTES_H_
#define IMPACTDIC_KERNELS_BYTES_H_

#include "kernels/lanes.h"

#define MIDDLE 128

// Pixels where every row begins as far from a whole word as the first one: that of `first`.
typedef struct Pixels {
  __global const uchar* first;
  __global const uint* words;  // about it
  uint bits;                   // from there
} Pixels;

INLINE Pixels pixels_from(__global const uchar* first) {
  const uint bytes = (uint)((uintptr_t)first & 3);
  const Pixels pixels = {first, (__global const uint*)(first - bytes), 8 * bytes};
  return pixels;
}

// Four of them of row y, about their middle. Behind the pictures there is room (DeviceFrames).
#if defined(WIDTH) && WIDTH % 4 == 0
#define IN_ROW(pixels, y) (pixels)
#define AT_ROW(y) ((y) * (WIDTH / 4))
#else
#define IN_ROW(pixels, y) pixels_from((pixels).first + (y)*ROW)
#define AT_ROW(y) 0
#endif

INLINE uint four_pixels(const Pixels pixels, const int width, const int y) {
  (void)width;
  const Pixels row = IN_ROW(pixels, y);
  __global const uint* words = row.words + AT_ROW(y);
  return (uint)(upsample(words[1], words[0]) >> row.bits) ^ 0x80808080u;
}

#ifdef MATRIX_UNITS
// sum + Σ of the products of four bytes.
INLINE int add_dot(const uint a, const uint b, const int sum) {
  int out;
  asm("dp4a.s32.s32 %0,%1,%2,%3;" : "=r"(out) : "r"(a), "r"(b), "r"(sum));
  return out;
}

// Four blocks of 8 rows of 16 bytes in local memory; work-item 8 k + i of the warp names row i of
// block k. Of every block it gets word lane % 4 of row lane / 4.
INLINE uint4 four_blocks(__local const uint* row) {
  uint4 out;
  asm volatile("ldmatrix.sync.aligned.m8n8.x4.shared.b16 {%0,%1,%2,%3},[%4];"
               : "=r"(out.x), "=r"(out.y), "=r"(out.z), "=r"(out.w)
               : "r"((uint)(uintptr_t)row));
  return out;
}

// Where a work-item's row for that is in 16 rows of 32 bytes, `pitch` words apart: blocks left and
// right above, left and right below.
INLINE int block_row(const int lane, const int pitch) {
  return (lane % 8 + 8 * (lane / 16)) * pitch + 4 * (lane / 8 % 2);
}

// Adds the product of 16 × 16 (below: 16 × 32) and 16 × 8 (32 × 8) bytes to 16 × 8 sums, of which a
// work-item of the warp holds four values: rows lane / 4 and 8 more, columns 2 (lane % 4) and 1
// more. a: word lane % 4 of rows lane / 4 and 8 more, then the same 16 bytes to the right; b: the
// same word of column lane / 4, then 16 bytes below.
INLINE void multiply_16(int* sums, const uint2 a, const uint b) {
  asm("mma.sync.aligned.m16n8k16.row.col.s32.s8.s8.s32 {%0,%1,%2,%3},{%4,%5},{%6},{%0,%1,%2,%3};"
      : "+r"(sums[0]), "+r"(sums[1]), "+r"(sums[2]), "+r"(sums[3])
      : "r"(a.x), "r"(a.y), "r"(b));
}

INLINE void multiply_32(int* sums, const uint4 a, const uint2 b) {
  asm("mma.sync.aligned.m16n8k32.row.col.s32.s8.s8.s32 "
      "{%0,%1,%2,%3},{%4,%5,%6,%7},{%8,%9},{%0,%1,%2,%3};"
      : "+r"(sums[0]), "+r"(sums[1]), "+r"(sums[2]), "+r"(sums[3])
      : "r"(a.x), "r"(a.y), "r"(a.z), "r"(a.w), "r"(b.x), "r"(b.y));
}
#else
INLINE int add_dot(const uint a, const uint b, const int sum) {
  const int4 products = convert_int4(as_char4(a)) * convert_int4(as_char4(b));
  return sum + ((products.x + products.y) + (products.z + products.w));
}
#endif

#endif  // IMPACTDIC_KERNELS_BYTES_H_
