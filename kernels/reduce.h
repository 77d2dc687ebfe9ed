// Sums over the work-items of a group of GROUP, a power of two.
#ifndef IMPACTDIC_KERNELS_REDUCE_H_
#define IMPACTDIC_KERNELS_REDUCE_H_

#include "kernels/vector.h"

// Sums formed at once. The odd row length keeps the work-items of one group in different banks.
#define REDUCE_ROWS 8
#define REDUCE_PITCH (GROUP + 1)
#define REDUCE_SCRATCH (REDUCE_ROWS * REDUCE_PITCH) /* floats of local memory */

// total[k] = Σ over the work-items of scratch[k · REDUCE_PITCH + item], k < count <= REDUCE_ROWS,
// pairwise. Every work-item of the group must call it; both arrays are free when it returns.
KERNEL_INLINE void sum_rows(const int count, __local float* scratch, __local float* total) {
  const int item = (int)get_local_id(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int upper = GROUP / 2; upper >= 16; upper /= 2) {
    if (item < upper) {
      for (int k = 0; k < count; ++k) {
        scratch[k * REDUCE_PITCH + item] += scratch[k * REDUCE_PITCH + item + upper];
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  const int left = GROUP < 16 ? GROUP : 16;
  for (int k = item; k < count; k += GROUP) {
    float sum = 0.0f;
    for (int i = 0; i < left; ++i) sum += scratch[k * REDUCE_PITCH + i];
    total[k] = sum;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// total[k] = Σ over work-items and lanes of own[k], k < count, a literal. Every work-item of the
// group must get here; scratch (REDUCE_SCRATCH) must be free.
#if GROUP == 1
#define GROUP_SUMS(own, count, scratch, total)                                                \
  {                                                                                           \
    (void)(scratch);                                                                          \
    _Pragma("unroll") for (int k_ = 0; k_ < (count); ++k_)(total)[k_] = SUM_LANES((own)[k_]); \
  }
#else
#define GROUP_SUMS(own, count, scratch, total)                                        \
  {                                                                                   \
    const int item_ = (int)get_local_id(0);                                           \
    _Pragma("unroll") for (int first_ = 0; first_ < (count); first_ += REDUCE_ROWS) { \
      _Pragma("unroll") for (int k_ = 0; k_ < REDUCE_ROWS; ++k_) {                    \
        if (first_ + k_ < (count)) {                                                  \
          (scratch)[k_ * REDUCE_PITCH + item_] = SUM_LANES((own)[first_ + k_]);       \
        }                                                                             \
      }                                                                               \
      sum_rows(min((count)-first_, REDUCE_ROWS), (scratch), (total) + first_);        \
    }                                                                                 \
  }
#endif

#endif  // IMPACTDIC_KERNELS_REDUCE_H_
