// Sums over the work-items of a group of GROUP, a power of two.
#ifndef IMPACTDIC_KERNELS_REDUCE_H_
#define IMPACTDIC_KERNELS_REDUCE_H_

#include "kernels/vector.h"

// Sums formed at once, each a row of local memory: the work-items' own sums, then those of
// neighbours. The odd length keeps the work-items of one group in different banks.
#define REDUCE_ROWS 8
#define REDUCE_PARTS (GROUP > REDUCE_ROWS ? GROUP / REDUCE_ROWS : 1)
#define REDUCE_PITCH ((GROUP + REDUCE_PARTS) | 1)
#define REDUCE_SCRATCH (REDUCE_ROWS * REDUCE_PITCH) /* floats */

// total[k] = Σ over the work-items of scratch[k · REDUCE_PITCH + item], k < count <= REDUCE_ROWS:
// every work-item sums some neighbours of one row, then one work-item a row sums those sums.
// Every work-item of the group must call it; both arrays are free when it returns.
BARRIER_INLINE void sum_rows(const int count, __local float* scratch, __local float* total) {
  const int item = (int)get_local_id(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int k = item; k < REDUCE_ROWS * REDUCE_PARTS; k += GROUP) {
    const int row = k % REDUCE_ROWS, part = k / REDUCE_ROWS;
    float sum = 0.0f;
    for (int i = 0; i < GROUP / REDUCE_PARTS; ++i) {
      sum += scratch[row * REDUCE_PITCH + part * (GROUP / REDUCE_PARTS) + i];
    }
    scratch[row * REDUCE_PITCH + GROUP + part] = sum;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int k = item; k < count; k += GROUP) {
    float sum = 0.0f;
    for (int i = 0; i < REDUCE_PARTS; ++i) sum += scratch[k * REDUCE_PITCH + GROUP + i];
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
#elif GROUP >= 128
// The loop stays a loop, for which the sums lie in an array that is indexed: unrolled it would be a
// fourth of what the compiler has to do for a ball, and many work-items hide what the array costs.
#define GROUP_SUMS(own, count, scratch, total)                                                  \
  {                                                                                             \
    const int item_ = (int)get_local_id(0);                                                     \
    float kept_[(count)];                                                                       \
    _Pragma("unroll") for (int k_ = 0; k_ < (count); ++k_) kept_[k_] = SUM_LANES((own)[k_]);    \
    _Pragma("unroll 1") for (int first_ = 0; first_ < (count); first_ += REDUCE_ROWS) {         \
      const int rows_ = min((count)-first_, REDUCE_ROWS);                                       \
      _Pragma("unroll 1") for (int k_ = 0; k_ < rows_; ++k_) {                                  \
        (scratch)[k_ * REDUCE_PITCH + item_] = kept_[first_ + k_];                              \
      }                                                                                         \
      sum_rows(rows_, (scratch), (total) + first_);                                             \
    }                                                                                           \
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
