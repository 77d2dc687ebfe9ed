// Local memory of the fused correlations: LANES work-items share a task, each holds columns of
// VECTOR neighbouring pixels and takes BLOCKS of them in turn. On a GPU: one column a work-item
// (VECTOR 1, BLOCKS 1), in registers from end to end. On a CPU: one work-item a task, rows in SIMD
// vectors.
#ifndef IMPACTDIC_KERNELS_LANES_H_
#define IMPACTDIC_KERNELS_LANES_H_

#include "kernels/config.h"

#define BLOCKS (FFT_PX / (LANES * VECTOR))
// Odd pitch for scalars: columns and rows are then both free of bank conflicts.
#define PITCH (FFT_PX + VECTOR)
#ifndef PLANE_ROWS
#define PLANE_ROWS FFT_PX
#endif
#define PLANE (PLANE_ROWS * PITCH)

#define PASTE_(a, b) a##b
#define PASTE(a, b) PASTE_(a, b)
#if VECTOR == 1
#define REAL float
#define INTEGER int
#define COLUMN_NUMBERS 0
#define PUT_VALUES(values, address) (*(address) = (values))
#define SUM(v) (v)
#define ELEMENT(v, k) (v)
#else
#define REAL PASTE(float, VECTOR)
#define INTEGER PASTE(int, VECTOR)
#define LOAD(p) PASTE(vload, VECTOR)(0, p)
#define STORE(v, p) PASTE(vstore, VECTOR)(v, 0, p)
#define PUT_VALUES(values, address) STORE(values, address)
#define ACROSS4(p) (p)[0], (p)[PITCH], (p)[2 * PITCH], (p)[3 * PITCH]
#if VECTOR == 4
#define LOAD_ACROSS(p) (float4)(ACROSS4(p))
#define COLUMN_NUMBERS (int4)(0, 1, 2, 3)
#define SUM(v) SUM4(v)
#elif VECTOR == 8
#define LOAD_ACROSS(p) (float8)(ACROSS4(p), ACROSS4((p) + 4 * PITCH))
#define COLUMN_NUMBERS (int8)(0, 1, 2, 3, 4, 5, 6, 7)
#define SUM(v) SUM4((v).lo + (v).hi)
#else
#define LOAD_ACROSS(p)                                                      \
  (float16)(ACROSS4(p), ACROSS4((p) + 4 * PITCH), ACROSS4((p) + 8 * PITCH), \
            ACROSS4((p) + 12 * PITCH))
#define COLUMN_NUMBERS (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#define SUM(v) SUM4(((v).lo + (v).hi).lo + ((v).lo + (v).hi).hi)
#endif
#define ELEMENT(v, k) (((const float*)&(v))[k])
#define SUM4(v) (((v).s0 + (v).s1) + ((v).s2 + (v).s3))
#endif

// Pixels from one row of a picture to the next. As a constant it lets a work-item read its column
// off one address.
#ifdef WIDTH
#define ROW WIDTH
#else
#define ROW width
#endif

// The arrays of a work-item stay in registers only where every loop over them is unrolled and every
// function that takes them inlined. Arrays of vectors do not fit in there anyway.
#if VECTOR == 1
#define UNROLL _Pragma("unroll")
#else
#define UNROLL
#endif
#define INLINE static inline __attribute__((always_inline))
// First column of block b of a work-item.
#define COLUMN(b) (((b)*LANES + lane) * VECTOR)
// With one block a work-item keeps its column in registers; a barrier then lets it write back what
// others have read.
#if BLOCKS == 1
#define ALL_HAVE_READ barrier(CLK_LOCAL_MEM_FENCE)
#else
#define ALL_HAVE_READ
#endif

// A plane holds PLANE_ROWS × FFT_PX pairs (re, im): side by side for scalars, so that one access
// moves both; as two pictures for vectors. AT: part 0 is re, 1 is im.
#if VECTOR == 1
#define AT(plane, part, column, row) ((plane)[2 * ((row)*PITCH + (column)) + (part)])
#define PUT(plane, column, row, re, im) \
  (((__local float2*)(plane))[(row)*PITCH + (column)] = (float2)((re), (im)))
#define GET(plane, column, row, re, im)                                            \
  {                                                                                \
    const float2 pair_ = ((__local const float2*)(plane))[(row)*PITCH + (column)]; \
    (re) = pair_.s0;                                                               \
    (im) = pair_.s1;                                                               \
  }
// Entry `column` of rows `row` … row + VECTOR − 1.
#define GET_ACROSS(plane, column, row, re, im) GET(plane, column, row, re, im)
#else
#define AT(plane, part, column, row) ((plane)[(part)*PLANE + (row)*PITCH + (column)])
#define PUT(plane, column, row, re, im)                    \
  {                                                        \
    STORE((re), (plane) + (row)*PITCH + (column));         \
    STORE((im), (plane) + PLANE + (row)*PITCH + (column)); \
  }
#define GET(plane, column, row, re, im)                    \
  {                                                        \
    (re) = LOAD((plane) + (row)*PITCH + (column));         \
    (im) = LOAD((plane) + PLANE + (row)*PITCH + (column)); \
  }
#define GET_ACROSS(plane, column, row, re, im)                    \
  {                                                               \
    (re) = LOAD_ACROSS((plane) + (row)*PITCH + (column));         \
    (im) = LOAD_ACROSS((plane) + PLANE + (row)*PITCH + (column)); \
  }
#endif

// Where the work-items of a group run in step as one warp of 32 anyway, it need not ask the others.
#ifdef WARP_BARRIER
#define GROUP_BARRIER asm volatile("bar.warp.sync 0xffffffff;" ::: "memory")
#else
#define GROUP_BARRIER barrier(CLK_LOCAL_MEM_FENCE)
#endif

// NVIDIA's compiler looks at -cl-nv-maxrregcount only where the size of a group is not fixed.
#ifdef FREE_GROUP_SIZE
#define GROUP_SIZE
#else
#define GROUP_SIZE __attribute__((reqd_work_group_size(LANES, 1, 1)))
#endif

// Floats as integers of the same order.
INLINE int in_order(const float x) {
  const int bits = as_int(x);
  return bits ^ (bits >> 31 & 0x7fffffff);
}

INLINE float from_order(const int order) { return as_float(order ^ (order >> 31 & 0x7fffffff)); }

#endif  // IMPACTDIC_KERNELS_LANES_H_
