// REAL: VECTOR neighbouring pixels of a row in one work-item. 1 on GPUs, where neighbouring
// work-items take neighbouring pixels; the width of the SIMD unit on CPUs.
#ifndef IMPACTDIC_KERNELS_VECTOR_H_
#define IMPACTDIC_KERNELS_VECTOR_H_

#include "kernels/config.h"

#ifndef __OPENCL_C_VERSION__
#define REAL float
#define KERNEL_INLINE inline
#define __global
#define __local
#else

#define KERNEL_INLINE static inline
// For functions with barriers: PoCL (3.1) runs a group's work-items in loops between barriers,
// which goes wrong, silently, in a function that it has not inlined.
#define BARRIER_INLINE __attribute__((always_inline)) static inline
#if VECTOR == 1
#define REAL float
#define INTEGER int
#define TO_INTEGER(x) ((int)(x))
#define LOAD_REAL(address) (*(address))
#define STORE_REAL(value, address) (*(address) = (value))
#define LANE_NUMBERS 0.0f
#define FIRST_LANE(x) (x)
#define LAST_LANE(x) (x)
#define SUM_LANES(x) (x)
#else
#define VECTOR_JOIN_(name, width) name##width
#define VECTOR_JOIN(name, width) VECTOR_JOIN_(name, width)
#define REAL VECTOR_JOIN(float, VECTOR)
#define INTEGER VECTOR_JOIN(int, VECTOR)
#define TO_INTEGER(x) VECTOR_JOIN(convert_int, VECTOR)(x)
#define LOAD_REAL(address) VECTOR_JOIN(vload, VECTOR)(0, address)
#define STORE_REAL(value, address) VECTOR_JOIN(vstore, VECTOR)(value, 0, address)
#define FIRST_LANE(x) ((x).s0)
#if VECTOR == 4
#define LANE_NUMBERS ((float4)(0, 1, 2, 3))
#define LAST_LANE(x) ((x).s3)
#elif VECTOR == 8
#define LANE_NUMBERS ((float8)(0, 1, 2, 3, 4, 5, 6, 7))
#define LAST_LANE(x) ((x).s7)
#elif VECTOR == 16
#define LANE_NUMBERS ((float16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15))
#define LAST_LANE(x) ((x).sf)
#endif

KERNEL_INLINE float sum_lanes4(const float4 x) { return (x.s0 + x.s1) + (x.s2 + x.s3); }
KERNEL_INLINE float sum_lanes8(const float8 x) { return sum_lanes4(x.lo + x.hi); }
KERNEL_INLINE float sum_lanes16(const float16 x) { return sum_lanes8(x.lo + x.hi); }
#define SUM_LANES(x) VECTOR_JOIN(sum_lanes, VECTOR)(x)
#if PARAMETERS == 5
// A sphere's pixels lie on curves: every lane is looked at.
KERNEL_INLINE float lowest_lane4(const float4 x) {
  return fmin(fmin(x.s0, x.s1), fmin(x.s2, x.s3));
}
KERNEL_INLINE float lowest_lane8(const float8 x) { return lowest_lane4(fmin(x.lo, x.hi)); }
KERNEL_INLINE float lowest_lane16(const float16 x) { return lowest_lane8(fmin(x.lo, x.hi)); }
#define LOWEST_LANE(x) VECTOR_JOIN(lowest_lane, VECTOR)(x)
#else
// Straight lines: the outer lanes tell.
#define LOWEST_LANE(x) fmin(FIRST_LANE(x), LAST_LANE(x))
#endif
#define HIGHEST_LANE(x) (-LOWEST_LANE(-(x)))
#endif

#endif  // __OPENCL_C_VERSION__
#endif  // IMPACTDIC_KERNELS_VECTOR_H_
