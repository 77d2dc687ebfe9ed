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

#endif  // IMPACTDIC_KERNELS_MOTION_H_
