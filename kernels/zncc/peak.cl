// Sub-pixel peaks of correlation maps: the highest point of the quintic spline through the map.
#include "kernels/config.h"
#include "kernels/motion.h"
#include "kernels/status.h"
#include "kernels/types.h"
#include "kernels/zncc/map_spline.h"

#define INLINE static inline __attribute__((always_inline))
#define NEWTON_STEPS 20
// The spline's peak lies within about half a pixel of the highest sample, on the diagonal of a long
// ridge somewhat farther.
#define FARTHEST 0.99f

// Value, slopes and second derivatives of the spline at (x, y) from the highest sample.
typedef struct Surface {
  float value, x, y, xx, xy, yy;
} Surface;

INLINE Surface surface_at(__local const float* coefficients, const float x, const float y) {
  const int left = (int)floor(x), top = (int)floor(y);
  float wx[6], dx[6], ddx[6], wy[6], dy[6], ddy[6];
  quintic_weights(x - (float)left, wx, dx, ddx);
  quintic_weights(y - (float)top, wy, dy, ddy);
  Surface s = {0, 0, 0, 0, 0, 0};
  for (int j = 0; j < 6; ++j) {
    __local const float* row = coefficients + (top + 1 + j) * PEAK_NEAR + left + 1;
    float value = 0, slope = 0, bend = 0;
#pragma unroll
    for (int i = 0; i < 6; ++i) {
      value += row[i] * wx[i];
      slope += row[i] * dx[i];
      bend += row[i] * ddx[i];
    }
    s.value += wy[j] * value;
    s.x += wy[j] * slope;
    s.xx += wy[j] * bend;
    s.y += dy[j] * value;
    s.xy += dy[j] * slope;
    s.yy += ddy[j] * value;
  }
  return s;
}

// A peak on its way from global memory, where neighbouring work-items would read far apart, as its
// 4-byte fields; an odd pitch keeps the work-items' banks apart.
#define PEAK_FIELDS ((int)(sizeof(CorrelationPeak) / 4))
#define PEAK_PITCH (PEAK_FIELDS | 1)
#define PEAK_HEAD (PEAK_FIELDS - PEAK_NEAR * PEAK_NEAR) /* fields before the coefficients */

INLINE void stage_peaks(__global const CorrelationPeak* peaks, const int count,
                        __local float* staged, const int lane) {
  __global const float* fields = (__global const float*)peaks;
#pragma unroll 8
  for (int k = lane; k < count * PEAK_FIELDS; k += MOTION_GROUP) {
    staged[k / PEAK_FIELDS * PEAK_PITCH + k % PEAK_FIELDS] = fields[k];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// The standard deviations follow from the residual: with ρ the correlation and n pixels, cov(u, v)
// = 2 (1 − ρ)/(n − 4) · (−∇∇ρ)⁻¹, four parameters (shift, gain, offset) being fitted.
INLINE WindowMotion motion_of(__local const float* fields, const float min_correlation,
                              const float window_pixels) {
  __local const CorrelationPeak* peak = (__local const CorrelationPeak*)fields;
  __local const float* coefficients = fields + PEAK_HEAD;
  if (peak->status != STATUS_OK) {
    return no_motion(peak->status, peak->value);
  }
  float x = peak->start_x, y = peak->start_y;
  Surface s = surface_at(coefficients, x, y);
  float determinant = s.xx * s.yy - s.xy * s.xy;
  int has_converged = 0;
  for (int step = 0; step < NEWTON_STEPS && !has_converged && determinant > 0.0f && s.xx < 0.0f;
       ++step) {
    const float scale = 1.0f / determinant;
    const float to_x = clamp(x + (s.xy * s.y - s.yy * s.x) * scale, -FARTHEST, FARTHEST);
    const float to_y = clamp(y + (s.xy * s.x - s.xx * s.y) * scale, -FARTHEST, FARTHEST);
    has_converged = fabs(to_x - x) < 1e-5f && fabs(to_y - y) < 1e-5f;
    x = to_x;
    y = to_y;
    s = surface_at(coefficients, x, y);
    determinant = s.xx * s.yy - s.xy * s.xy;
  }
  has_converged &= fabs(x) < FARTHEST && fabs(y) < FARTHEST && determinant > 0.0f && s.xx < 0.0f;
  if (!has_converged) {
    return no_motion(STATUS_NOT_CONVERGED, peak->value);
  }
  const float correlation = fmin(s.value, 1.0f);
  if (correlation < min_correlation) {
    return no_motion(STATUS_LOW_CORRELATION, correlation);
  }
  const float residual = 2.0f * (1.0f - correlation) / (window_pixels - 4.0f);
  WindowMotion motion;
  motion.u = (float)peak->shift_x + x;
  motion.v = (float)peak->shift_y + y;
  motion.u_sd = sqrt(residual * -s.yy / determinant);
  motion.v_sd = sqrt(residual * -s.xx / determinant);
  motion.correlation = correlation;
  motion.peak_ratio = peak->value / fmax(peak->second, 1e-3f * peak->value);
  motion.ux = motion.uy = motion.vx = motion.vy = 0.0f;
  motion.status = STATUS_OK;
  return motion;
}

// peaks: (count), of the windows from `start` on; motions: `count` written from `start` on. One
// work-item a window; the last group may overhang.
__kernel __attribute__((reqd_work_group_size(MOTION_GROUP, 1, 1))) void zncc_subpixel(
    __global const CorrelationPeak* peaks, const uint start, const uint count,
    const float min_correlation, const float window_pixels, __global WindowMotion* motions) {
  __local int finished[MOTION_GROUP * MOTION_FIELDS];
  __local float staged[MOTION_GROUP * PEAK_PITCH];
  const int lane = (int)get_local_id(0);
  const uint at = (uint)get_global_id(0), first = at - (uint)lane;
  stage_peaks(peaks + first, (int)min((uint)MOTION_GROUP, count - first), staged, lane);
  if (at < count) {
    stage_motion(motion_of(staged + lane * PEAK_PITCH, min_correlation, window_pixels), finished);
  }
  write_motions(finished, count, motions + start);
}
