// What else blurring does along a turn, where the warp is curved: it shifts the picture, and skews
// it. With V the warp back, from a place y of the second picture to one of the first, and b the
// variance of what blurs, V of a blurred place has the mean b/2 ΔV and the third cumulants of
// b² V' ∇∇V V'^T (V' and ∇∇V its derivatives), so that beside what blur.h has
//   g∘W − f = b/2 ∇f·ΔV + b²/2 Σ (V' ∇∇V_k V'^T)_ij f_ijk.
// V is curved by the depth z alone: ∇∇V_k = q_k ∇∇z, q what a point moves by as it comes nearer.
// The next order, which is left out, counts from a tilt of 8° on.
#ifndef IMPACTDIC_KERNELS_BALL_BEND_H_
#define IMPACTDIC_KERNELS_BALL_BEND_H_

#include "kernels/ball/pixels.h"

// What blurs, in shares of BallTask.blur, which is larger since second differences see too little.
#define BLUR_OF_BENDS 0.9f
// Sines of the tilt, up to which bends are taken off wholly, and from which on not at all.
#define FULL_BEND 0.14f
#define NO_BEND 0.21f

// What of a ball's bends is taken off.
static inline float bend_share(__local const float* turn) {
  if (turn[8] < 0.0f) return 0.0f;
  const float sine = sqrt(turn[6] * turn[6] + turn[7] * turn[7]);
  return clamp((NO_BEND - sine) * (1.0f / (NO_BEND - FULL_BEND)), 0.0f, 1.0f);
}

// What bends change of the pixels from (px, py) on, with lines of sight taken to be parallel; in
// grey levels of the first picture, whose planes are `value`.
BARRIER_INLINE REAL bend_change(__global const float* value, const View view, const BallTask task,
                                const BallLimits limits, __local const Shared* shared, const int px,
                                const int py) {
  __local const float* turn = shared->turn;
  const size_t plane = (size_t)limits.height * limits.plane_pitch;
  __global const float* slope_x = value + plane + (size_t)py * limits.plane_pitch + px;
  __global const float* slope_y = slope_x + plane;
  const float radius = shared->radius, blur = BLUR_OF_BENDS * task.blur;
  const REAL from_x = LANE_NUMBERS + ((float)(px - (int)view.whole_cx) - view.rest_cx);
  const REAL from_y = (REAL)((float)(py - (int)view.whole_cy) - view.rest_cy);
  const REAL from_z = sqrt(fmax(radius * radius - from_x * from_x - from_y * from_y, (REAL)0.0f));
  const REAL x = turn[0] * from_x + turn[1] * from_y + turn[2] * from_z;
  const REAL y = turn[3] * from_x + turn[4] * from_y + turn[5] * from_z;
  const REAL z = turn[6] * from_x + turn[7] * from_y + turn[8] * from_z;
  const REAL by_depth = 1.0f / fmax(z, (REAL)(LEAST_DEPTH * radius));
  const REAL tilt_x = x * by_depth, tilt_y = y * by_depth;
  const REAL tilt2 = tilt_x * tilt_x + tilt_y * tilt_y;
  // V', and V' along the slope of the depth.
  const float q_x = turn[6], q_y = turn[7];
  const REAL xx = turn[0] - q_x * tilt_x, xy = turn[3] - q_x * tilt_y;
  const REAL yx = turn[1] - q_y * tilt_x, yy = turn[4] - q_y * tilt_y;
  const REAL along_x = xx * tilt_x + xy * tilt_y, along_y = yx * tilt_x + yy * tilt_y;
  Blurring skew;
  skew.xx = -by_depth * (xx * xx + xy * xy + along_x * along_x);
  skew.xy = -by_depth * (xx * yx + xy * yy + along_x * along_y);
  skew.yy = -by_depth * (yx * yx + yy * yy + along_y * along_y);
  const REAL shifted =
      -by_depth * (2.0f + tilt2) * (q_x * LOAD_REAL(slope_x) + q_y * LOAD_REAL(slope_y));
  const REAL skewed =
      q_x * blur_change(slope_x, limits.plane_pitch, px, py, limits.width, limits.height, skew) +
      q_y * blur_change(slope_y, limits.plane_pitch, px, py, limits.width, limits.height, skew);
  return 0.5f * blur * shifted + blur * blur * skewed;
}

#endif  // IMPACTDIC_KERNELS_BALL_BEND_H_
