// What some neighbouring pixels of the first picture say of the motion: where the motion so far
// takes them in the second picture, and the columns of the regression there.
#ifndef IMPACTDIC_KERNELS_BALL_PIXELS_H_
#define IMPACTDIC_KERNELS_BALL_PIXELS_H_

#include "kernels/ball/blur.h"
#include "kernels/ball/registration.h"
#if LIT
#include "kernels/ball/light.h"
#endif

// True where a coordinate that runs straight from `first` to `last` stays beyond the same border.
static inline int beyond(const float first, const float last, const float most) {
  return (first < 0.0f && last < 0.0f) || (first > most && last > most);
}

// Whole pixels apart, floats keep their digits for the position about the centre.
typedef struct View {
  float whole_cx, whole_cy, rest_cx, rest_cy;  // the centre in the first picture
  float t_x, t_y;                              // and in the second, from pixel (base_x, base_y)
  int base_x, base_y;
} View;

BARRIER_INLINE View view_of(const BallTask task, __local const float* warp) {
  View view;
  view.whole_cx = rint(task.cx);
  view.whole_cy = rint(task.cy);
  view.rest_cx = task.cx - view.whole_cx;
  view.rest_cy = task.cy - view.whole_cy;
  const float whole_x = rint(warp[4]), whole_y = rint(warp[5]);
  view.t_x = view.rest_cx + (warp[4] - whole_x);
  view.t_y = view.rest_cy + (warp[5] - whole_y);
  view.base_x = (int)view.whole_cx + (int)whole_x;
  view.base_y = (int)view.whole_cy + (int)whole_y;
  return view;
}

// value: the first picture's planes; second: coefficient of pixel (0, 0) of the second picture;
// mask: weights of the first picture's pixels (MASKED 1). The pixels from (px, py) on: their
// weights, without the robust ones, and their columns, the last of which is the residual r. 0 where
// none of them counts; then nothing is set.
BARRIER_INLINE int see_pixels(__global const float* value, __global const float* second,
                              __global const float* mask, const View view, const BallTask task,
                              const Box box, const BallLimits limits, __local const Shared* shared,
                              const int px, const int py, REAL* weight, REAL* column) {
  (void)mask;
#if VECTOR == 1
  if (px >= box.x1) return 0;
#endif
  if (py >= box.y1) return 0;
  const size_t plane = (size_t)limits.height * limits.plane_pitch;
  const float most_x = (float)(limits.width - 1), most_y = (float)(limits.height - 1);
  const float by_radius = 1.0f / task.radius;
  const REAL x = LANE_NUMBERS + ((float)(px - (int)view.whole_cx) - view.rest_cx);
  const REAL y = (REAL)((float)(py - (int)view.whole_cy) - view.rest_cy);
  const REAL zero = 0.0f, one = 1.0f;
  REAL lit = one;  // light where the second picture shows the surface, over that of the first one
#if PARAMETERS == SPHERE
  __local const float* turn = shared->turn;
#if SHAPED
  const OnBall on = point_seen(&shared->seen[0], shared->radius, x, y);
  const REAL z = on.z;
  const REAL turned_x = turn[0] * on.x + turn[1] * on.y + turn[2] * z;
  const REAL turned_y = turn[3] * on.x + turn[4] * on.y + turn[5] * z;
  const REAL turned_z = turn[6] * on.x + turn[7] * on.y + turn[8] * z;
  __local const Seen* then = &shared->seen[1];
  const float near = shared->seen[0].by_distance;
  const float aside_x = then->aside_x + near * shared->warp[4];
  const float aside_y = then->aside_y + near * shared->warp[5];
  const REAL closer = one / (one - near * turned_z);
  const REAL lands_x = (then->xx * turned_x + then->xy * turned_y + aside_x * turned_z) * closer;
  const REAL lands_y = (then->xy * turned_x + then->yy * turned_y + aside_y * turned_z) * closer;
  REAL w = seen_share(fmin(
      facing(near, shared->seen[0].aside_x, shared->seen[0].aside_y, shared->radius, on.x, on.y, z),
      facing(near, aside_x, aside_y, shared->radius, turned_x, turned_y, turned_z)));
  w = on.within2 < task.radius * task.radius ? w : zero;
  // Lines of sight lean by T in the first picture and by lean_x, lean_y in the second.
  const REAL bent_x = aside_x + near * lands_x, bent_y = aside_y + near * lands_y;
  const REAL lean_x = then->inverse_xx * bent_x + then->inverse_xy * bent_y;
  const REAL lean_y = then->inverse_xy * bent_x + then->inverse_yy * bent_y;
  const REAL by_depth = one / fmax(turned_z - turned_x * lean_x - turned_y * lean_y,
                                   (REAL)(LEAST_DEPTH * shared->radius));
  Across across = {turn[0] + lean_x * turn[6], turn[1] + lean_x * turn[7],
                   turn[3] + lean_y * turn[6], turn[4] + lean_y * turn[7],
                   turn[2] + lean_x * turn[8], turn[5] + lean_y * turn[8]};
  across.x -= across.xx * on.ray_x + across.xy * on.ray_y;
  across.y -= across.yx * on.ray_x + across.yy * on.ray_y;
  const REAL slant = on.slant;
  const REAL from_x = on.x, from_y = on.y;
  const Blurring change = blurring(across, on.x, on.y, slant, by_depth);
#else
  const REAL depth2 = shared->radius * shared->radius - x * x - y * y;
  const REAL z = sqrt(fmax(depth2, zero));
  const REAL turned_x = turn[0] * x + turn[1] * y + turn[2] * z;
  const REAL turned_y = turn[3] * x + turn[4] * y + turn[5] * z;
  const REAL turned_z = turn[6] * x + turn[7] * y + turn[8] * z;
  const REAL lands_x = turned_x, lands_y = turned_y;
  REAL w = seen_share(fmin(z, turned_z) / shared->radius);
  const REAL by_depth = one / fmax(turned_z, (REAL)(LEAST_DEPTH * shared->radius));
  const Across across = {turn[0], turn[1], turn[3], turn[4], turn[2], turn[5]};
  const REAL slant = z;
  const REAL from_x = x, from_y = y;
  const Blurring change = blurring(across, x, y, slant, by_depth);
#endif
#if LIT
  const float by_ball = 1.0f / shared->radius;
  lit = light_at(&shared->lamp, turned_x * by_ball, turned_y * by_ball, turned_z * by_ball) /
        light_at(&shared->lamp, from_x * by_ball, from_y * by_ball, z * by_ball);
  w *= 2.0f / (1.0f + lit * lit);  // the noise of f goes with the light
#else
  (void)from_x, (void)from_y;
#endif
  w *= blur_share(change, task.blur);
#if BENDS
  // Both pictures' noise in an area of the first one, of which the second one shows less: the same
  // whichever picture is the first, so that noise of a picture cancels along a chain of pairs.
  w *= 2.0f / (1.0f + slant * by_depth);
#else
  (void)slant;
#endif
  // Behind the rim a position is of no use, but it is read.
  const REAL to_x =
      clamp(view.t_x + lands_x, (REAL)(float)-view.base_x, (REAL)(most_x - (float)view.base_x));
  const REAL to_y =
      clamp(view.t_y + lands_y, (REAL)(float)-view.base_y, (REAL)(most_y - (float)view.base_y));
  const REAL view_x = view.t_x + lands_x + (float)view.base_x;
  const REAL view_y = view.t_y + lands_y + (float)view.base_y;
  w = x * x + y * y < task.radius * task.radius ? w : zero;
#else
  const REAL to_x = view.t_x + shared->warp[0] * x + shared->warp[1] * y;
  const REAL to_y = view.t_y + shared->warp[2] * x + shared->warp[3] * y;
  const REAL view_x = to_x + (float)view.base_x, view_y = to_y + (float)view.base_y;
  if (beyond(FIRST_LANE(view_x), LAST_LANE(view_x), most_x) ||
      beyond(FIRST_LANE(view_y), LAST_LANE(view_y), most_y)) {
    return 0;
  }
  REAL w = x * x + y * y < task.radius * task.radius ? one : zero;
#endif
  w = x + (view.rest_cx + view.whole_cx) < (float)box.x1 - 0.5f ? w : zero;
  w = fmin(view_x, most_x - view_x) >= 0.0f ? w : zero;
  w = fmin(view_y, most_y - view_y) >= 0.0f ? w : zero;
#if MASKED
  w *= LOAD_REAL(mask + (size_t)py * limits.mask_pitch + px);
#endif
#if VECTOR == 1
  if (w == 0.0f) return 0;
#elif PARAMETERS == SPHERE
  if (SUM_LANES(w) == 0.0f) return 0;
#endif
  __global const float* at = value + (size_t)py * limits.plane_pitch + px;
  __global const float* origin = second + view.base_y * limits.pitch + view.base_x;
  const REAL f = lit * LOAD_REAL(at) - shared->origin;
  // Light is a factor: its gradients go with the grey level itself.
  const REAL along_x = (f + shared->origin) * x * by_radius;
  const REAL along_y = (f + shared->origin) * y * by_radius;
  REAL slope_x = lit * LOAD_REAL(at + plane), slope_y = lit * LOAD_REAL(at + 2 * plane);
#if LIT
  // The light does not move with the ball: its slopes tell nothing of where that has gone.
  REAL fading[3];
  light_slopes(&shared->lamp, from_x * by_ball, from_y * by_ball, z * by_ball, fading);
  for (int k = 0; k < 3; ++k) fading[k] *= (f + shared->origin) * by_ball;
#if !SHAPED
  const REAL in_depth = fading[2] / fmax(z, (REAL)(LEAST_DEPTH * shared->radius));
  slope_x -= fading[0] - in_depth * x;
  slope_y -= fading[1] - in_depth * y;
#endif
#endif
  const REAL g = spline_sample(origin, limits.pitch, to_x, to_y) - shared->origin;
  *weight = w;
  column[0] = one;
  column[1] = f;
  column[2] = along_x;
  column[3] = along_y;
#if PARAMETERS == SPHERE && SHAPED
  // The same as below with lines of sight that lean, where what is near moves farther. The centre's
  // displacement moves points by more than itself: 1 / (1 - k z) times.
  REAL slant_x = shared->seen[0].xx * slope_x + shared->seen[0].xy * slope_y;
  REAL slant_y = shared->seen[0].xy * slope_x + shared->seen[0].yy * slope_y;
  REAL slant_z = slant_x * on.ray_x + slant_y * on.ray_y;
#if LIT
  slant_x -= fading[0] * (one - near * z);
  slant_y -= fading[1] * (one - near * z);
  slant_z -= fading[2] * (one - near * z);
#endif
  const REAL first_closer = one / (one - near * z);
  REAL moved[3];  // by a px of the turned ball along each axis
  for (int k = 0; k < 3; ++k) {
    moved[k] = first_closer *
               (turn[3 * k] * slant_x + turn[3 * k + 1] * slant_y + turn[3 * k + 2] * slant_z);
  }
  const REAL in_depth = by_depth * (lean_x * moved[0] + lean_y * moved[1] - moved[2]);
  const REAL across_x = moved[0] + turned_x * in_depth;
  const REAL across_y = moved[1] + turned_y * in_depth;
  column[4] = then->inverse_xx * across_x + then->inverse_xy * across_y;
  column[5] = then->inverse_xy * across_x + then->inverse_yy * across_y;
  column[6] = (slant_y * z - slant_z * on.y) * (first_closer * by_radius);
  column[7] = (slant_x * z - slant_z * on.x) * (first_closer * by_radius);
  column[8] = (slant_x * on.y - slant_y * on.x) * (first_closer * by_radius);
#if FREE_RADIUS
  // A larger sphere has its points nearer along their lines of sight.
  const REAL out_x = turn[2] - turn[0] * on.ray_x - turn[1] * on.ray_y;
  const REAL out_y = turn[5] - turn[3] * on.ray_x - turn[4] * on.ray_y;
  const REAL out_z = turn[8] - turn[6] * on.ray_x - turn[7] * on.ray_y;
  column[9] = ((out_x + lean_x * out_z) * across_x + (out_y + lean_y * out_z) * across_y) *
              (shared->radius / fmax(on.slant, one));
#endif
#if FREE_DISTANCE
  // A nearer camera sees along lines that lean more, in the first picture by V^-1 (p + a), a from
  // the optical axis to the centre, and by as much in the second. What is told is k times the
  // disc's radius squared, px.
  const float near_first_x = shared->away[0][0], near_first_y = shared->away[0][1];
  const REAL open_x = shared->seen[0].inverse_xx * (x + near_first_x) +
                      shared->seen[0].inverse_xy * (y + near_first_y);
  const REAL open_y = shared->seen[0].inverse_xy * (x + near_first_x) +
                      shared->seen[0].inverse_yy * (y + near_first_y);
  const REAL rise = z * (on.x * open_x + on.y * open_y) / fmax(on.slant, one);
  const REAL slide_x = -open_x * z - on.ray_x * rise, slide_y = -open_y * z - on.ray_y * rise;
  const REAL to_z = turn[6] * slide_x + turn[7] * slide_y + turn[8] * rise;
  const REAL sight_x = shared->away[1][0] + shared->warp[4] + lands_x;
  const REAL sight_y = shared->away[1][1] + shared->warp[5] + lands_y;
  const REAL open_then_x = then->inverse_xx * sight_x + then->inverse_xy * sight_y;
  const REAL open_then_y = then->inverse_xy * sight_x + then->inverse_yy * sight_y;
  const REAL by_x = turn[0] * slide_x + turn[1] * slide_y + turn[2] * rise + lean_x * to_z +
                    open_then_x * turned_z;
  const REAL by_y = turn[3] * slide_x + turn[4] * slide_y + turn[5] * rise + lean_y * to_z +
                    open_then_y * turned_z;
  column[10] = (by_x * across_x + by_y * across_y) * (by_radius * by_radius);
#endif
#elif PARAMETERS == SPHERE
  // Where a shift of the second picture leads on the first one's sphere: along the sphere at the
  // turned point (x right or y down, and in depth to stay on it), turned back.
  const REAL tilt_x = turned_x * by_depth, tilt_y = turned_y * by_depth;
  column[4] = slope_x * (turn[0] - tilt_x * turn[6]) + slope_y * (turn[1] - tilt_x * turn[7]);
  column[5] = slope_x * (turn[3] - tilt_y * turn[6]) + slope_y * (turn[4] - tilt_y * turn[7]);
  column[6] = slope_y * z * by_radius;
  column[7] = slope_x * z * by_radius;
  column[8] = (slope_x * y - slope_y * x) * by_radius;
#if FREE_RADIUS
  // A larger sphere has all of its points at a greater depth.
  column[9] = (turn[2] * column[4] + turn[5] * column[5]) * (shared->radius / fmax(z, one));
#endif
#elif PARAMETERS == 3
  column[4] = slope_x;
  column[5] = slope_y;
  column[6] = (slope_x * y - slope_y * x) * by_radius;
#else
  column[4] = slope_x;
  column[5] = slope_x * x * by_radius;
  column[6] = slope_x * y * by_radius;
  column[7] = slope_y;
  column[8] = slope_y * x * by_radius;
  column[9] = slope_y * y * by_radius;
#endif
#if PARAMETERS == SPHERE
#if FREE_CENTRE
  // With the centre elsewhere in both pictures the second one shows the ball displaced, and a pixel
  // of the first one another of its points.
#if SHAPED
  column[REGRESSORS - 2] = column[4] - first_closer * slope_x;
  column[REGRESSORS - 1] = column[5] - first_closer * slope_y;
#else
  column[REGRESSORS - 2] = column[4] - slope_x;
  column[REGRESSORS - 1] = column[5] - slope_y;
#endif
#endif
  // Like the slopes, in grey levels of the first picture.
  const REAL blurred =
      lit * task.blur *
      blur_change(at, limits.plane_pitch, px, py, limits.width, limits.height, change);
#else
  const REAL blurred = zero;
#endif
  column[REGRESSORS] = g - shared->light[0] - shared->light[1] * (f + blurred) -
                       shared->light[2] * along_x - shared->light[3] * along_y;
  return 1;
}

#endif  // IMPACTDIC_KERNELS_BALL_PIXELS_H_
