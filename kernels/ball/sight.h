// A sphere that is seen from near by or that is compressed. With k one over the distance, s the
// direction of its centre from the optical axis and V its stretch in the picture's plane, the point
// q of the round ball about its centre, z towards the camera, is seen at
//   p = (V q_xy + s z) / (1 - k z),
// p from the centre's picture. The line of sight through p is q_xy = P - T z with P = V^-1 p and
// T = V^-1 (s + k p).
#ifndef IMPACTDIC_KERNELS_BALL_SIGHT_H_
#define IMPACTDIC_KERNELS_BALL_SIGHT_H_

#include "kernels/types.h"
#include "kernels/vector.h"

typedef struct Seen {
  float by_distance, aside_x, aside_y;   // k, and s of a centre that is where it was guessed
  float xx, xy, yy;                      // V
  float inverse_xx, inverse_xy, inverse_yy;
} Seen;

static inline Seen seen_with(const float by_distance, const float aside_x, const float aside_y,
                             const float* strain) {
  Seen seen;
  seen.by_distance = by_distance;
  seen.aside_x = aside_x;
  seen.aside_y = aside_y;
  seen.xx = 1.0f + strain[0];
  seen.xy = strain[1];
  seen.yy = 1.0f + strain[2];
  const float by_area = 1.0f / (seen.xx * seen.yy - seen.xy * seen.xy);
  seen.inverse_xx = seen.yy * by_area;
  seen.inverse_xy = -seen.xy * by_area;
  seen.inverse_yy = seen.xx * by_area;
  return seen;
}

// A point of the round ball and the line of sight through it.
typedef struct OnBall {
  REAL x, y, z;
  REAL ray_x, ray_y;  // T
  REAL slant;         // z - T q_xy: 0 where the line of sight touches the ball
  REAL within2;       // P squared
} OnBall;

// The point that is seen (x, y) px from the centre's picture; beside the ball where the line of
// sight comes nearest to it.
BARRIER_INLINE OnBall point_seen(__local const Seen* seen, const float radius, const REAL x,
                                 const REAL y) {
  const REAL aside_x = seen->by_distance * x + seen->aside_x;
  const REAL aside_y = seen->by_distance * y + seen->aside_y;
  const REAL in_x = seen->inverse_xx * x + seen->inverse_xy * y;
  const REAL in_y = seen->inverse_xy * x + seen->inverse_yy * y;
  OnBall on;
  on.ray_x = seen->inverse_xx * aside_x + seen->inverse_xy * aside_y;
  on.ray_y = seen->inverse_xy * aside_x + seen->inverse_yy * aside_y;
  on.within2 = in_x * in_x + in_y * in_y;
  const REAL across = in_x * on.ray_x + in_y * on.ray_y;
  const REAL length2 = on.ray_x * on.ray_x + on.ray_y * on.ray_y + 1.0f;
  on.slant =
      sqrt(fmax(across * across - length2 * (on.within2 - radius * radius), (REAL)0.0f));
  on.z = (across + on.slant) / length2;
  on.x = in_x - on.ray_x * on.z;
  on.y = in_y - on.ray_y * on.z;
  return on;
}

// Cosine of the surface's angle to the line of sight at a point of the ball.
static inline REAL facing(const float by_distance, const float aside_x, const float aside_y,
                          const float radius, const REAL x, const REAL y, const REAL z) {
  return (z - aside_x * x - aside_y * y - by_distance * radius * radius) /
         (radius * (1.0f - by_distance * z));
}

#endif  // IMPACTDIC_KERNELS_BALL_SIGHT_H_
