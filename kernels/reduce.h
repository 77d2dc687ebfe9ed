// Sums over the work-items of a group of GROUP, a power of two.
#ifndef IMPACTDIC_KERNELS_REDUCE_H_
#define IMPACTDIC_KERNELS_REDUCE_H_

#include "kernels/vector.h"

// Floats of local memory that group_sums needs for `count` sums. The odd row length keeps the
// work-items of one group in different banks.
#define REDUCE_SCRATCH(count) ((count) * (GROUP + 1))

// total[k] = Σ over work-items and lanes of own[k], k < count, pairwise. Every work-item of the
// group must call it; total may be read when it returns. Neither may `scratch` be in use.
#define GROUP_SUMS(own, count, scratch, total)                    \
  {                                                               \
    const int item_ = (int)get_local_id(0);                       \
    for (int k_ = 0; k_ < (count); ++k_) {                        \
      (scratch)[k_ * (GROUP + 1) + item_] = SUM_LANES((own)[k_]); \
    }                                                             \
    sum_columns((count), (scratch), (total));                     \
  }

KERNEL_INLINE void sum_columns(const int count, __local float* scratch, __local float* total) {
  const int item = (int)get_local_id(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int upper = GROUP / 2; upper >= 16; upper /= 2) {
    if (item < upper) {
      for (int k = 0; k < count; ++k) {
        scratch[k * (GROUP + 1) + item] += scratch[k * (GROUP + 1) + item + upper];
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  const int left = GROUP < 16 ? GROUP : 16;
  for (int k = item; k < count; k += GROUP) {
    float sum = 0.0f;
    for (int i = 0; i < left; ++i) sum += scratch[k * (GROUP + 1) + i];
    total[k] = sum;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

#endif  // IMPACTDIC_KERNELS_REDUCE_H_
