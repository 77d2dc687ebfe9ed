// Order statistics of some hundred values in local memory.
#ifndef IMPACTDIC_KERNELS_RIM_QUANTILE_H_
#define IMPACTDIC_KERNELS_RIM_QUANTILE_H_

#include "kernels/vector.h"

// The value that `rank` others are below or equal to; exact. Every work-item of the group must call
// it; `found` and the values may be changed again behind a barrier.
BARRIER_INLINE float ranked(__local const float* values, const int count, const int rank,
                            __local float* found) {
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = (int)get_local_id(0); i < count; i += GROUP) {
    const float value = values[i];
    int below = 0;
    for (int k = 0; k < count; ++k) {
      below += values[k] < value || (values[k] == value && k < i) ? 1 : 0;
    }
    if (below == rank) *found = value;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  return *found;
}

// The value below which the share `q` of the values, one at least, lies, to half of `tolerance`; of
// one work-item alone.
BARRIER_INLINE float near_quantile(__local const float* values, const int count, const float q,
                                   const float tolerance) {
  float low = values[0], high = values[0];
  for (int i = 1; i < count; ++i) {
    low = fmin(low, values[i]);
    high = fmax(high, values[i]);
  }
  const float rank = q * (float)count;
  while (high - low > tolerance) {
    const float pivot = 0.5f * (low + high);
    if (!(pivot > low && pivot < high)) break;
    int up_to = 0;
    for (int i = 0; i < count; ++i) up_to += values[i] <= pivot ? 1 : 0;
    if ((float)up_to > rank) {
      high = pivot;
    } else {
      low = pivot;
    }
  }
  return 0.5f * (low + high);
}

#endif  // IMPACTDIC_KERNELS_RIM_QUANTILE_H_
