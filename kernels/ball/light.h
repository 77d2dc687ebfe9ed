// The light on a sphere, fixed to the camera: paint that a turn carries from one normal of the
// surface to another changes its grey level by what the light there is over what it was. Beside a
// lamp's shadow that is far from linear in the place, which is all that the free gains follow.
#ifndef IMPACTDIC_KERNELS_BALL_LIGHT_H_
#define IMPACTDIC_KERNELS_BALL_LIGHT_H_

#include "kernels/types.h"
#include "kernels/vector.h"

// What bare paint shows at the normal (x, y, z): see BallLight.
static inline REAL light_at(__local const BallLight* light, const REAL x, const REAL y,
                            const REAL z) {
  const REAL lit = light->lamp[0] * x + light->lamp[1] * y + light->lamp[2] * z;
  return fmax(light->ambient + fmax(lit, (REAL)0.0f), (REAL)light->least);
}

// By what share it grows as the normal is moved by `along`; 0 in the lamp's shadow.
static inline void light_slopes(__local const BallLight* light, const REAL x, const REAL y,
                                const REAL z, REAL* along) {
  const REAL lit = light->lamp[0] * x + light->lamp[1] * y + light->lamp[2] * z;
  const REAL level = light->ambient + lit, none = 0.0f;
  const REAL share = 1.0f / fmax(level, (REAL)light->least);
  const REAL seen = fmin(lit, level - light->least);
  for (int k = 0; k < 3; ++k) along[k] = seen > none ? light->lamp[k] * share : none;
}

#endif  // IMPACTDIC_KERNELS_BALL_LIGHT_H_
