// Registration of a whole ball between two frames, rigid or affine: inverse-compositional
// Gauss–Newton (Baker and Matthews 2004) on every pixel of a disc, with offset and gain free, the
// gain linear in the place since light does not turn with the ball, and Tukey's biweight against
// whatever does not move with it (Beaton and Tukey 1974). With f the first picture, g∘W the second
// one under the warp so far and r = g∘W − offset − (gain + gain_x X/R + gain_y Y/R) f, each step
// solves the weighted regression
//   r ≈ δoffset + (δgain + δgain_x X/R + δgain_y Y/R) f + gain ∇fᵀ D δ
// PARAMETERS 3: D δ = (du + dθ Y, dv − dθ X); 6: (du + ux X + uy Y, dv + vx X + vy Y), X from the
// centre. A sphere (5) is turned in depth: W(X) = d + (Q q)_xy with q = (X, √(R² − X²)) and Q in
// SO(3), pixels that are turned out of sight have no weight, and
//   D δ = P δd + (Z, δθ), P a shift of the second picture as it looks on the first one's sphere.
// Its motions are composed as Q exp(−δθ), d − δd. FREE_CENTRE 1: a centre that is told by δc too
// far off is found as (P − 1) δc, with what was told of it. SHAPED 1: in perspective, or compressed
// (sight.h). LIT 1: f is what the light makes of the first picture where the second one shows it
// (light.h). The scale of the weights is the median of |r| of the step before (a histogram's).
#include "kernels/ball/pass.h"
#include "kernels/ball/scores.h"
#include "kernels/ball/step.h"
#include "kernels/ball/store.h"
#if PARAMETERS == SPHERE
#include "kernels/ball/sphere_store.h"
#endif

// coefficients, planes: of SplineFrames (prefilter.cl), the former from element `offset` on.
// smooth_taps: (SMOOTH_RADIUS + 1) weights of the pre-smoothing. noise: see warp_noise, and
// in its last element the noise variance of the first picture. mask: weights of the pixels of the
// pictures that the frames are parts of, with these `corners`, one a slot (MASKED 1; else not
// read). One group of GROUP a task.
__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void register_balls(
    __global const float* coefficients, const int offset, __global const float* planes,
    __global const BallTask* tasks, __global BallMotion* motions, const BallLimits limits,
    __constant float* smooth_taps, const float4 noise, __global const float* mask,
    __global const int2* corners) {
  __local float scratch[SCORE_SCRATCH > REDUCE_SCRATCH ? SCORE_SCRATCH : REDUCE_SCRATCH];
  __local Shared shared;
  const int item = (int)get_local_id(0);
  BallTask task = tasks[get_group_id(0)];
#if FREE_CENTRE
  const BallTask told = task;
#endif
#if MASKED
  mask += corners[task.first].y * limits.mask_pitch + corners[task.first].x;
#else
  (void)corners;
#endif
  const int cx = clamp((int)rint(task.cx), 0, limits.width - 1);
  const int cy = clamp((int)rint(task.cy), 0, limits.height - 1);
  __global const float* value =
      planes + (size_t)task.first * 3 * limits.height * limits.plane_pitch;
  __global const float* second =
      coefficients + offset +
      (size_t)task.second * (limits.height + 2 * SPLINE_PAD) * limits.pitch +
      SPLINE_PAD * limits.pitch + SPLINE_PAD;
  if (item == 0) {
    warp_start(shared.warp, task.guess_dx, task.guess_dy, task.guess_rot_rad);
#if PARAMETERS == SPHERE
    shared.radius = task.ball_radius;
    shared.centre[0] = task.cx;
    shared.centre[1] = task.cy;
#if LIT
    shared.lamp = task.light;
#endif
#if SHAPED
    shared.seen[0] =
        seen_with(task.sight.by_distance, task.sight.first_x, task.sight.first_y, task.sight.first);
    shared.seen[1] = seen_with(task.sight.by_distance, task.sight.second_x, task.sight.second_y,
                               task.sight.second);
#if FREE_DISTANCE
    const float by_told = 1.0f / task.sight.by_distance;
    shared.away[0][0] = by_told * task.sight.first_x;
    shared.away[0][1] = by_told * task.sight.first_y;
    shared.away[1][0] = by_told * task.sight.second_x;
    shared.away[1][1] = by_told * task.sight.second_y;
#endif
#endif
    turn_start(shared.turn, task.guess_rot_x_rad, task.guess_rot_y_rad, task.guess_rot_rad);
#endif
    shared.origin = value[(size_t)cy * limits.plane_pitch + cx];
    shared.scale = shared.bin = shared.carried = 0.0f;
    for (int i = 0; i < LIGHT; ++i) shared.light[i] = i == 1 ? 1.0f : 0.0f;
    shared.correlation = NAN;
    shared.variance = NAN;
    shared.steps = 0;
    shared.moved = 0.0f;
    shared.pace = UNKNOWN_PACE;
    shared.coarse = task.radius >= COARSE_RADIUS_PX;
    shared.status = STATUS_RUNNING;
  }
  for (int k = 0; k < limits.max_steps; ++k) {
    for (int b = item; b < BINS; b += GROUP) shared.histogram[b] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (shared.status != STATUS_RUNNING) break;
#if FREE_CENTRE
    task.cx = shared.centre[0];
    task.cy = shared.centre[1];
#endif
    // Read before the first work-item can go on to change it.
    const int counted = shared.bin > 0.0f;
    const Box box = disc_box(task, shared.coarse, limits.width, limits.height);
    pass(value, second, mask, task, box, limits, scratch, &shared);
    if (counted) sum_bins(&shared);
#if FREE_CENTRE
    if (item == 0) tell_centre(&shared, task, told, limits);
#endif
    if (item == 0) step(&shared, task, limits);
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  const Box box = disc_box(task, 0, limits.width, limits.height);
  const float share = smoothed_share(value, box, task, limits, smooth_taps, scratch, &shared);
  sum_scores(value, second, mask, task, box, limits, scratch, &shared);
#if PARAMETERS != SPHERE
  const float second_noise =
      warp_noise(shared.warp, (float2)(task.cx, task.cy), 0.6f * task.radius, noise, shared.noise);
#endif
  if (item != 0) return;
  int status = shared.status;
  if (status == STATUS_RUNNING) status = STATUS_NOT_CONVERGED;
  if (status == STATUS_OK &&
      !(shared.correlation >= limits.min_correlation && shared.kept >= LEAST_KEPT)) {
    status = STATUS_LOW_CORRELATION;
  }
  __global BallMotion* out = &motions[get_group_id(0)];
  out->status = status;
  out->steps = shared.steps;
  out->correlation = shared.correlation;
  out->residual = sqrt(shared.variance);
  out->used = shared.carried / compared_area(task, limits);
#if PARAMETERS == SPHERE
  (void)noise;
  if (status == STATUS_OK) {
    store_sphere(out, &shared, task.radius, task.centre_sd, 2.0f * ROUNDING_VARIANCE * share);
  } else {
    store_failure(out);
  }
#else
  if (status == STATUS_OK) {
    // The residual holds both frames' noise, the second one's after interpolation; pixels are
    // rounded to whole grey levels, which is noise that a residual need not show.
    const float pixel_variance =
        fmax(shared.variance / (noise.w + second_noise), ROUNDING_VARIANCE);
    const float scale = sqrt(2.0f * pixel_variance * share);
    store_motion(out, &shared);
    store_deviations(out, &shared, task.radius, scale / shared.light[1]);
  } else {
    store_failure(out);
  }
#endif
}
