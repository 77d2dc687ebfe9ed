// Pixels of 8 bits as signed bytes about their middle, four in a word, and what multiplies them:
// with MATRIX_UNITS that of NVIDIA's devices (PTX's mma and dp4a), elsewhere plain C.
#ifndef IMPACTDIC_KERNELS_BYTES_H_
#define IMPACTDIC_KERNELS_BYTES_H_

#include "kernels/lanes.h"

#define MIDDLE 128

// 16 bytes from `first` on, about their middle. Behind the pictures there is room (DeviceFrames).
INLINE uint4 sixteen_pixels(__global const uchar* first) {
  const uint bits = 8 * (uint)((uintptr_t)first & 3);
  __global const uint* words = (__global const uint*)(first - bits / 8);
  const uint4 low = (uint4)(words[0], words[1], words[2], words[3]);
  const uint4 high = (uint4)(low.yzw, words[4]);
  return convert_uint4(upsample(high, low) >> (ulong4)(bits)) ^ 0x80808080u;
}

#ifdef MATRIX_UNITS
// sum + Σ of the products of four bytes.
INLINE int add_dot(const uint a, const uint b, const int sum) {
  int out;
  asm("dp4a.s32.s32 %0,%1,%2,%3;" : "=r"(out) : "r"(a), "r"(b), "r"(sum));
  return out;
}

// Adds a product of matrices of 16 × 16 (below: 16 × 32) and 16 × 8 (32 × 8) bytes to one of 16 × 8
// sums, of which a work-item of the warp holds four values; what it holds of the factors is called
// after where it stands in them.
INLINE void multiply_16(int* sums, const uint a, const uint below, const uint b) {
  asm("mma.sync.aligned.m16n8k16.row.col.s32.s8.s8.s32 {%0,%1,%2,%3},{%4,%5},{%6},{%0,%1,%2,%3};"
      : "+r"(sums[0]), "+r"(sums[1]), "+r"(sums[2]), "+r"(sums[3])
      : "r"(a), "r"(below), "r"(b));
}

INLINE void multiply_32(int* sums, const uint a, const uint below, const uint right,
                        const uint right_below, const uint b, const uint b_below) {
  asm("mma.sync.aligned.m16n8k32.row.col.s32.s8.s8.s32 "
      "{%0,%1,%2,%3},{%4,%5,%6,%7},{%8,%9},{%0,%1,%2,%3};"
      : "+r"(sums[0]), "+r"(sums[1]), "+r"(sums[2]), "+r"(sums[3])
      : "r"(a), "r"(below), "r"(right), "r"(right_below), "r"(b), "r"(b_below));
}
#else
INLINE int add_dot(const uint a, const uint b, const int sum) {
  const int4 products = convert_int4(as_char4(a)) * convert_int4(as_char4(b));
  return sum + ((products.x + products.y) + (products.z + products.w));
}
#endif

// Sum of 16 bytes, and of the products of 16 and 16.
INLINE int sum_of(const uint4 a) {
  const uint ones = 0x01010101u;
  return add_dot(a.x, ones, add_dot(a.y, ones, add_dot(a.z, ones, add_dot(a.w, ones, 0))));
}

INLINE int dot_of(const uint4 a, const uint4 b) {
  return add_dot(a.x, b.x, add_dot(a.y, b.y, add_dot(a.z, b.z, add_dot(a.w, b.w, 0))));
}

#endif  // IMPACTDIC_KERNELS_BYTES_H_
