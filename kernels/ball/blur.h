// What blurs a picture (lens, pixel, pre-smoothing) does so in the picture and not on the ball:
// where a turn stretches the surface, a speckle is not the same picture before and after. With the
// variance b of the blur and J the warp's derivative, the second picture, led back onto the first,
// is blurred by b J^-1 J^-T there instead of b. To first order in the difference
//   g∘W − f = b/2 tr(C ∇∇fᵀ),  C = J^-1 J^-T − 1.
// Lines of sight lean where the camera is near; that what is nearer is also larger, and a
// compression, change C by a few hundredths more, which are left out.
#ifndef IMPACTDIC_KERNELS_BALL_BLUR_H_
#define IMPACTDIC_KERNELS_BALL_BLUR_H_

#include "kernels/ball/registration.h"

typedef struct Blurring {
  REAL xx, xy, yy;  // C
} Blurring;

// What a shift (dx, dy) across the first line of sight does across the second one, for points of a
// plane across the first (xx ... yy), and for what a point comes nearer along with it (x, y).
typedef struct Across {
  REAL xx, xy, yx, yy, x, y;
} Across;

// At (x, y) from the centre, where the line of sight is `slant` from touching the ball in the first
// picture and 1 / by_slant in the second: z before and after the turn, with parallel rays.
static inline Blurring blurring(const Across turn, const REAL x, const REAL y, const REAL slant,
                                const REAL by_slant) {
  // J times the slant, whose determinant is the product of both slants.
  const REAL xx = turn.xx * slant - turn.x * x, xy = turn.xy * slant - turn.x * y;
  const REAL yx = turn.yx * slant - turn.y * x, yy = turn.yy * slant - turn.y * y;
  const REAL by_area = by_slant * by_slant;
  Blurring c;
  c.xx = (yy * yy + xy * xy) * by_area - 1.0f;
  c.yy = (yx * yx + xx * xx) * by_area - 1.0f;
  c.xy = -(yy * yx + xy * xx) * by_area;
  return c;
}

// tr(C ∇∇fᵀ) / 2 by differences of the plane `at` points into, at pixel (px, py) and those beside
// it in a unit; 0 at the border of a picture of width × height.
static inline REAL blur_change(__global const float* at, const int pitch, const int px,
                               const int py, const int width, const int height, const Blurring c) {
  if (py == 0 || py == height - 1 || (px == 0 && py == 1)) return (REAL)0.0f;
  __global const float *above = at - pitch, *below = at + pitch;
  const REAL twice = 2.0f * LOAD_REAL(at);
  const REAL xx = LOAD_REAL(at + 1) + LOAD_REAL(at - 1) - twice;
  const REAL yy = LOAD_REAL(below) + LOAD_REAL(above) - twice;
  const REAL xy = 0.25f * (LOAD_REAL(below + 1) - LOAD_REAL(below - 1) - LOAD_REAL(above + 1) +
                           LOAD_REAL(above - 1));
  const REAL change = 0.5f * (c.xx * xx + c.yy * yy) + c.xy * xy;
  const REAL x = LANE_NUMBERS + (float)px;
  return fmin(x, (float)(width - 1) - x) > 0.5f ? change : (REAL)0.0f;
}

// Of a pixel whose blur changes by far, what is left beside the first order grows with its square.
static inline REAL blur_share(const Blurring c, const float blur) {
  const REAL size =
      (c.xx * c.xx + c.yy * c.yy + 2.0f * c.xy * c.xy) * (blur * blur * (1.0f / BLUR_CHANGE));
  return 1.0f / (1.0f + size * size);
}

#endif  // IMPACTDIC_KERNELS_BALL_BLUR_H_
