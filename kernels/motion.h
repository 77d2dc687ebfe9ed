// Results of windows that could not be measured.
#ifndef IMPACTDIC_KERNELS_MOTION_H_
#define IMPACTDIC_KERNELS_MOTION_H_

#include "kernels/status.h"
#include "kernels/types.h"

// Only a status and a correlation (NAN where there is none); all else not a number.
static inline WindowMotion no_motion(const int status, const float correlation) {
  WindowMotion motion;
  motion.u = motion.v = motion.u_sd = motion.v_sd = NAN;
  motion.correlation = correlation;
  motion.peak_ratio = NAN;
  motion.ux = motion.uy = motion.vx = motion.vy = NAN;
  motion.status = status;
  return motion;
}

// Results on their way to global memory, where neighbouring work-items would write far apart: every
// work-item of a group of MOTION_GROUP puts its own into local memory, and all write them together.
#define MOTION_GROUP 32
#define MOTION_FIELDS 11

static inline void stage_motion(const WindowMotion motion, __local int* staged) {
  *(__local WindowMotion*)(staged + get_local_id(0) * MOTION_FIELDS) = motion;
}

// motions: `count`, of which the group writes those of its work-items' global numbers. Every
// work-item of the group must call it; passes a barrier.
__attribute__((always_inline)) static inline void write_motions(__local const int* staged,
                                                                const uint count,
                                                                __global WindowMotion* motions) {
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint first = (uint)get_group_id(0) * MOTION_GROUP;
  if (first >= count) return;
  const uint fields = min(count - first, (uint)MOTION_GROUP) * MOTION_FIELDS;
  __global int* to = (__global int*)(motions + first);
#pragma unroll
  for (uint k = 0; k < MOTION_FIELDS; ++k) {
    const uint at = k * MOTION_GROUP + (uint)get_local_id(0);
    if (at < fields) to[at] = staged[at];
  }
}

#endif  // IMPACTDIC_KERNELS_MOTION_H_
