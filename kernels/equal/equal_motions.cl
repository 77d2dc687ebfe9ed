// Equal windows: of the circular correlation of mean-free windows (equal.cl, equal_bytes.cl) each
// value over the share of the windows that overlaps at its lag, and the Gaussian through the
// highest one and its neighbours (Westerweel 1997).
#include "kernels/config.h"
#include "kernels/equal/equal.h"
#include "kernels/motion.h"

#define HALF_PX (FFT_PX / 2)

INLINE int lag_of(const int at) { return at < HALF_PX ? at : at - FFT_PX; }

INLINE WindowMotion motion_of(const Window window, const int in_view,
                              __global const EqualPeak* peak, const float min_contrast,
                              const float min_correlation) {
  const int lag_x = lag_of(peak->x), lag_y = lag_of(peak->y);
  float cross[CROSS];
  UNROLL
  for (int arm = 0; arm < CROSS; ++arm) {
    const int x = lag_of((peak->x + FFT_PX + (arm == 2) - (arm == 1)) % FFT_PX);
    const int y = lag_of((peak->y + FFT_PX + (arm == 4) - (arm == 3)) % FFT_PX);
    cross[arm] = peak->cross[arm] / (float)((FFT_PX - abs(x)) * (FFT_PX - abs(y)));
  }
  const float centre = cross[0];
  const float correlation = fmin(centre / (sqrt(peak->energy[0]) * sqrt(peak->energy[1])), 1.0f);
  float shift[2], bend[2];
  int is_peak = 1;
  UNROLL
  for (int axis = 0; axis < 2; ++axis) {
    const float before = cross[1 + 2 * axis] / centre;
    const float after = cross[2 + 2 * axis] / centre;
    const float left = log(before), right = log(after);
    bend[axis] = -(left + right);
    shift[axis] = 0.5f * (right - left) / bend[axis];
    is_peak &= before > 0.0f && after > 0.0f && bend[axis] > 0.0f;
  }
  const float least = min_contrast * min_contrast * PIXELS;
  const int status = !in_view                                         ? STATUS_OUT_OF_VIEW
                     : fmin(peak->energy[0], peak->energy[1]) < least ? STATUS_NO_TEXTURE
                     : lag_x == -HALF_PX || lag_y == -HALF_PX         ? STATUS_AT_SEARCH_EDGE
                     : correlation < min_correlation                  ? STATUS_LOW_CORRELATION
                     : !is_peak                                       ? STATUS_NOT_CONVERGED
                                                                      : STATUS_OK;
  WindowMotion motion = no_motion(status, correlation);
  if (status != STATUS_OK) return motion;
  // As in peak.cl, with the Gaussian's bend; u and v apart.
  const float residual = 2.0f * (1.0f - correlation) / (PIXELS - 4.0f);
  motion.u = (float)(window.guess_u + lag_x) + shift[0];
  motion.v = (float)(window.guess_v + lag_y) + shift[1];
  motion.u_sd = sqrt(residual / (correlation * bend[0]));
  motion.v_sd = sqrt(residual / (correlation * bend[1]));
  motion.ux = motion.uy = motion.vx = motion.vy = 0.0f;
  return motion;
}

// windows, peaks: (count); motions: `count` written. One work-item of MOTION_GROUP a window; the
// last group may overhang.
__kernel __attribute__((reqd_work_group_size(MOTION_GROUP, 1, 1))) void equal_motions(
    __global const Window* windows, __global const EqualPeak* peaks, const int width,
    const int height, const uint count, const float min_contrast, const float min_correlation,
    __global WindowMotion* motions) {
  __local int staged[MOTION_GROUP * MOTION_FIELDS];
  const uint at = (uint)get_global_id(0);
  if (at < count) {
    const Window window = windows[at];
    stage_motion(motion_of(window, place_of(window, width, height).in_view, peaks + at,
                           min_contrast, min_correlation),
                 staged);
  }
  write_motions(staged, count, motions);
}
