// Affine warps W(X) = t + A X about a centre, six floats in local memory: a00 a01 a10 a11 t0 t1.
#ifndef IMPACTDIC_KERNELS_WARP_H_
#define IMPACTDIC_KERNELS_WARP_H_

#include "kernels/vector.h"

// Displacement (u, v) and a turn, counter-clockwise as seen with y down.
KERNEL_INLINE void warp_start(__local float* w, const float u, const float v, const float turn) {
  w[0] = w[3] = cos(turn);
  w[1] = sin(turn);
  w[2] = -sin(turn);
  w[4] = u;
  w[5] = v;
}

// W becomes W ∘ D⁻¹, D(X) = (s4, s5) + S X, S = (s0 s1; s2 s3).
KERNEL_INLINE void warp_compose_inverse(__local float* w, const float s0, const float s1,
                                        const float s2, const float s3, const float s4,
                                        const float s5) {
  const float scale = 1.0f / (s0 * s3 - s1 * s2);
  for (int i = 0; i < 2; ++i) {
    const float left = w[2 * i], right = w[2 * i + 1];
    w[2 * i] = (left * s3 - right * s2) * scale;
    w[2 * i + 1] = (right * s0 - left * s1) * scale;
    w[4 + i] -= w[2 * i] * s4 + w[2 * i + 1] * s5;
  }
}

// Variance of a spline between pixels in units of the noise's: A + B c + C c² along each axis,
// c = cos 2πt, t the position's fraction (noise = A, B, C; interpolation_noise of
// host/dic/spline_taps.h). Mean over the square of half side `reach` about `centre`, whose pixels
// the warp may all lay differently. Every work-item of the group must call it; `parts` holds
// NOISE_PLACES².
#define NOISE_PLACES 5
BARRIER_INLINE float warp_noise(__local const float* w, const float2 centre, const float reach,
                                const float4 noise, __local float* parts) {
  for (int k = (int)get_local_id(0); k < NOISE_PLACES * NOISE_PLACES; k += GROUP) {
    const float step = 2.0f / (NOISE_PLACES - 1) * reach;
    const float x = step * (float)(k % NOISE_PLACES) - reach;
    const float y = step * (float)(k / NOISE_PLACES) - reach;
    const float cx = cospi(2.0f * (centre.x + w[4] + w[0] * x + w[1] * y));
    const float cy = cospi(2.0f * (centre.y + w[5] + w[2] * x + w[3] * y));
    parts[k] =
        (noise.x + cx * (noise.y + cx * noise.z)) * (noise.x + cy * (noise.y + cy * noise.z));
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  float sum = 0.0f;
  for (int k = 0; k < NOISE_PLACES * NOISE_PLACES; ++k) sum += parts[k];
  return sum / (NOISE_PLACES * NOISE_PLACES);
}

#endif  // IMPACTDIC_KERNELS_WARP_H_
