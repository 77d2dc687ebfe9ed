#include "kernels/config.h"
#include "kernels/linalg.h"
#include "kernels/reduce.h"
#include "kernels/spline.h"
#include "kernels/types.h"
#include "kernels/warp.h"

// Registration of a whole ball between two frames, rigid or affine: inverse-compositional
// Gauss–Newton (Baker and Matthews 2004) on every pixel of a disc, with offset and gain free, the
// gain linear in the place since light does not turn with the ball, and Tukey's biweight against
// whatever does not move with it (Beaton and Tukey 1974). With f the first picture, g∘W the second
// one under the warp so far and r = g∘W − offset − (gain + gain_x X/R + gain_y Y/R) f, each step
// solves the weighted regression
//   r ≈ δoffset + (δgain + δgain_x X/R + δgain_y Y/R) f + gain ∇fᵀ D δ
// PARAMETERS 3: D δ = (du + dθ Y, dv − dθ X); 6: (du + ux X + uy Y, dv + vx X + vy Y), X from the
// centre. The scale of the weights is the median of |r| of the step before (a histogram's).

#define LIGHT 4                         /* 1, f, f X/R, f Y/R */
#define REGRESSORS (LIGHT + PARAMETERS) /* and the slopes by the parameters over the radius */
#define COLUMNS (REGRESSORS + 1)        /* and r */
#define PRODUCTS (COLUMNS * (COLUMNS + 1) / 2)
#define NEWTON PRODUCTS       /* then: the weights' share of Newton's matrix, see biweight */
#define CHANGE (PRODUCTS + 1) /* what w r² gains by the logarithm of the scale */
#define SUMS (PRODUCTS + 2)
#define BINS 256
#define PART_BINS 16
#define ROUNDING_VARIANCE (1.0f / 12.0f)

// A step after which no pixel is further than this from where further ones would take it is the
// last: far below what noise of one grey level does to a ball. What is left of a step is taken to
// be its share that the step before it had left, at least the first of these, and the second where
// there was no such step.
#define LEFT_PX 6e-5f
#define SMALLEST_PACE 0.01f
#define UNKNOWN_PACE 0.2f
#define SHORTEST_STEP_PX 3e-4f /* what remains of a step below this says nothing about pace */
// The first steps of a large disc see one row in so many, and of those one unit in so many, until
// they are this small.
#define COARSE_ROWS 4
#define COARSE_UNITS 2
#define COARSE_RADIUS_PX 64.0f
#define COARSE_PX 0.02f
// Steps above this are still far from the minimum: outliers cannot be told yet.
#define NEAR_PX 0.5f
// Residuals of this many scales have no weight: 98 % efficient on normal noise.
#define TUKEY 6.0f
// A pass whose weights had this much another scale than its residuals (logarithm) is not the last
// one. Below, what the weights' sums would be with the other scale follows to first order.
#define SAME_SCALE 0.06f
// With weights that are held, each step leaves the same share of the way; Newton's, which tells how
// they change, is longer. At most so much, since it need not be positive where most are outliers.
#define LONGEST_STRETCH 1.3f
// The scale is not taken to be smaller than this, grey levels of 255: where there is no noise,
// rounding and interpolation are largest at the edges, which must not look like outliers.
#define SMALLEST_SCALE 1.0f
#define SMALLEST_PIVOT 1e-6f
#define SMALLEST_SHARE 0.2f /* of the disc, in view and with weight */

// WindowStatus of host/dic/field.h.
#define STATUS_OK 0
#define STATUS_NO_TEXTURE 2
#define STATUS_LOW_CORRELATION 3
#define STATUS_NOT_CONVERGED 5
#define STATUS_OUT_OF_VIEW 6
#define STATUS_RUNNING (-1)

// What the work-items of a group share about their ball.
typedef struct Shared {
  float warp[6];
  float origin;                 // grey level taken off both pictures
  float light[LIGHT];           // coefficients of the light's regressors so far
  float scale;                  // of the weights, 0: all equal
  float bin;                    // width of a bin of the histogram, 0: none is made
  float correlation, variance;  // at the last step
  float carried;                // sum of weights
  float moved, pace;            // of the last step, px; see LEFT_PX
  int coarse;                   // not 0: the next pass does not see all pixels
  int status, steps;
  float sums[SUMS];
  float solution[REGRESSORS];
  float noise[NOISE_PLACES * NOISE_PLACES];
  float smoothed[2];
  int histogram[BINS];
  int parts[BINS / PART_BINS];
} Shared;

// What is compared has this area, px: the disc, or the mask's pixels in it.
static inline float compared_area(const BallTask task, const BallLimits limits) {
  return limits.mask_area > 0.0f ? limits.mask_area : 3.14159265f * task.radius * task.radius;
}

// Work-items side by side take a tile of this many columns and rows: where the ball has turned, a
// row of pixels lies across as many cache lines of the second picture.
#if VECTOR == 1
#define TILE_X 8
#define TILE_Y 4
#else
#define TILE_X 1
#define TILE_Y 1
#endif

// The disc's bounding box within the first picture, in units of VECTOR pixels.
typedef struct Box {
  int x0, y0, x1, y1;  // half open
  int rows, apart;     // every how many-th row is seen, and first pixel to first pixel of a unit
  int tiles;           // across
} Box;

static inline Box disc_box(const BallTask task, const int coarse, const int width,
                           const int height) {
  Box box;
  box.x0 = max(0, (int)ceil(task.cx - task.radius));
  box.y0 = max(0, (int)ceil(task.cy - task.radius));
  box.x1 = min(width, (int)floor(task.cx + task.radius) + 1);
  box.y1 = min(height, (int)floor(task.cy + task.radius) + 1);
  box.rows = coarse ? COARSE_ROWS : 1;
  box.apart = (coarse ? COARSE_UNITS : 1) * VECTOR;
  const int across = TILE_X * box.apart;
  box.tiles = max(0, (box.x1 - box.x0 + across - 1) / across);
  return box;
}

// Those of the last tiles may lie beyond the box.
static inline int unit_count(const Box box) {
  const int down = max(0, (box.y1 - box.y0 + box.rows - 1) / box.rows);
  return (down + TILE_Y - 1) / TILE_Y * box.tiles * TILE_X * TILE_Y;
}
// First pixel of a unit.
static inline int unit_x(const Box box, const int unit) {
  return box.x0 + (unit / (TILE_X * TILE_Y) % box.tiles * TILE_X + unit % TILE_X) * box.apart;
}
static inline int unit_y(const Box box, const int unit) {
  return box.y0 +
         box.rows * (unit / (TILE_X * TILE_Y) / box.tiles * TILE_Y + unit / TILE_X % TILE_Y);
}

// True where a coordinate that runs straight from `first` to `last` stays beyond the same border.
static inline int beyond(const float first, const float last, const float most) {
  return (first < 0.0f && last < 0.0f) || (first > most && last > most);
}

// Tukey's biweight w(r); newton: d(w r)/dr.
static inline REAL biweight(const REAL r, const float scale, REAL* newton) {
  const REAL u = r * (1.0f / (TUKEY * scale));
  const REAL rest = fmax(1.0f - u * u, (REAL)0.0f);
  *newton = rest * (1.0f - 5.0f * u * u);
  return rest * rest;
}

static inline void count_residuals(const REAL r, const REAL weight, const float bin,
                                   __local int* histogram) {
#if VECTOR == 1
  if (weight > 0.0f) atomic_inc(&histogram[min((int)(fabs(r) / bin), BINS - 1)]);
#else
  int bins[VECTOR];
  float weights[VECTOR];
  const REAL one = fmin(fabs(r) * (1.0f / bin), (REAL)(BINS - 1));
  VECTOR_JOIN(vstore, VECTOR)(TO_INTEGER(one), 0, bins);
  STORE_REAL(weight, weights);
  for (int lane = 0; lane < VECTOR; ++lane) {
    if (weights[lane] > 0.0f) atomic_inc(&histogram[bins[lane]]);
  }
#endif
}

// One pass over the disc: the weighted sums of products of all columns, and the histogram.
// value: the first picture's planes; second: coefficient of pixel (0, 0) of the second picture.
BARRIER_INLINE void pass(__global const float* value, __global const float* second,
                         __global const float* mask, const BallTask task, const Box box,
                         const BallLimits limits, __local float* scratch, __local Shared* shared) {
  (void)mask;
  const int item = (int)get_local_id(0);
  const size_t plane = (size_t)limits.height * limits.plane_pitch;
  const int units = unit_count(box);
  // Whole pixels apart, floats keep their digits for the position about the centre.
  const float whole_cx = rint(task.cx), whole_cy = rint(task.cy);
  const float rest_cx = task.cx - whole_cx, rest_cy = task.cy - whole_cy;
  const float whole_x = rint(shared->warp[4]), whole_y = rint(shared->warp[5]);
  const float t_x = rest_cx + (shared->warp[4] - whole_x);
  const float t_y = rest_cy + (shared->warp[5] - whole_y);
  const int base_x = (int)whole_cx + (int)whole_x, base_y = (int)whole_cy + (int)whole_y;
  __global const float* origin = second + base_y * limits.pitch + base_x;
  const float most_x = (float)(limits.width - 1), most_y = (float)(limits.height - 1);
  const float by_radius = 1.0f / task.radius;
  REAL sums[SUMS];
  for (int k = 0; k < SUMS; ++k) sums[k] = 0.0f;
  for (int unit = item; unit < units; unit += GROUP) {
    const int py = unit_y(box, unit), px = unit_x(box, unit);
#if VECTOR == 1
    if (px >= box.x1) continue;
#endif
    if (py >= box.y1) continue;
    const REAL x = LANE_NUMBERS + ((float)(px - (int)whole_cx) - rest_cx);
    const REAL y = (REAL)((float)(py - (int)whole_cy) - rest_cy);
    const REAL to_x = t_x + shared->warp[0] * x + shared->warp[1] * y;
    const REAL to_y = t_y + shared->warp[2] * x + shared->warp[3] * y;
    const REAL view_x = to_x + (float)base_x, view_y = to_y + (float)base_y;
    if (beyond(FIRST_LANE(view_x), LAST_LANE(view_x), most_x) ||
        beyond(FIRST_LANE(view_y), LAST_LANE(view_y), most_y)) {
      continue;
    }
    const REAL zero = 0.0f, one = 1.0f;
    REAL w = x * x + y * y < task.radius * task.radius ? one : zero;
    w = x + (rest_cx + whole_cx) < (float)box.x1 - 0.5f ? w : zero;
    w = fmin(view_x, most_x - view_x) >= 0.0f ? w : zero;
    w = fmin(view_y, most_y - view_y) >= 0.0f ? w : zero;
#if MASKED
    w *= LOAD_REAL(mask + (size_t)py * limits.plane_pitch + px);
#endif
#if VECTOR == 1
    if (w == 0.0f) continue;
#endif
    __global const float* at = value + (size_t)py * limits.plane_pitch + px;
    const REAL f = LOAD_REAL(at) - shared->origin;
    // Light is a factor: its gradients go with the grey level itself.
    const REAL along_x = (f + shared->origin) * x * by_radius;
    const REAL along_y = (f + shared->origin) * y * by_radius;
    const REAL slope_x = LOAD_REAL(at + plane), slope_y = LOAD_REAL(at + 2 * plane);
    const REAL g = spline_sample(origin, limits.pitch, to_x, to_y) - shared->origin;
    const REAL r = g - shared->light[0] - shared->light[1] * f - shared->light[2] * along_x -
                   shared->light[3] * along_y;
    if (shared->bin > 0.0f) count_residuals(r, w, shared->bin, shared->histogram);
    REAL newton = 1.0f;
    const REAL robust = shared->scale > 0.0f ? biweight(r, shared->scale, &newton) : one;
    sums[NEWTON] += w * newton;
    sums[CHANGE] += w * (robust - newton) * r * r;  // dw/d(log scale) = w − d(w r)/dr
    w *= robust;
    REAL column[COLUMNS];
    column[0] = 1.0f;
    column[1] = f;
    column[2] = along_x;
    column[3] = along_y;
#if PARAMETERS == 3
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
    column[REGRESSORS] = r;
#pragma unroll
    for (int i = 0; i < COLUMNS; ++i) {
      const REAL weighted = w * column[i];
#pragma unroll
      for (int j = 0; j <= i; ++j) sums[TRIANGLE(i, j)] += weighted * column[j];
    }
  }
  GROUP_SUMS(sums, SUMS, scratch, shared->sums)
}

// Σ a b − Σ a Σ b / Σ 1 of two columns, column >= other.
static inline float covariance(__local const float* sums, const int column, const int other) {
  return sums[TRIANGLE(column, other)] -
         sums[TRIANGLE(column, 0)] * sums[TRIANGLE(other, 0)] / sums[0];
}

// ZNCC under the weights, from the sums: g = r + Σ light · regressor.
static inline float correlation(__local const Shared* shared) {
  __local const float* s = shared->sums;
  float fg = covariance(s, REGRESSORS, 1), gg = covariance(s, REGRESSORS, REGRESSORS);
  for (int i = 1; i < LIGHT; ++i) {
    fg += shared->light[i] * covariance(s, i, 1);
    gg += 2.0f * shared->light[i] * covariance(s, REGRESSORS, i);
    for (int j = 1; j < LIGHT; ++j) {
      gg += shared->light[i] * shared->light[j] * covariance(s, max(i, j), min(i, j));
    }
  }
  return fg / sqrt(covariance(s, 1, 1) * gg);
}

// Applies the solution to the warp. Returns the largest displacement of a pixel by it, px.
static inline float move(__local Shared* shared, const float radius) {
  __local const float* s = shared->solution + LIGHT;
  const float by_gain = 1.0f / shared->light[1], by_both = by_gain / radius;
#if PARAMETERS == 3
  const float du = s[0] * by_gain, dv = s[1] * by_gain, turn = s[2] * by_both;
  warp_compose_inverse(shared->warp, cos(turn), sin(turn), -sin(turn), cos(turn), du, dv);
  return fmax(fabs(du), fabs(dv)) + fabs(turn) * radius;
#else
  const float du = s[0] * by_gain, ux = s[1] * by_both, uy = s[2] * by_both;
  const float dv = s[3] * by_gain, vx = s[4] * by_both, vy = s[5] * by_both;
  warp_compose_inverse(shared->warp, 1.0f + ux, uy, vx, 1.0f + vy, du, dv);
  return fmax(fabs(du) + radius * (fabs(ux) + fabs(uy)), fabs(dv) + radius * (fabs(vx) + fabs(vy)));
#endif
}

// Sums of PART_BINS bins of the histogram each, so that no single work-item adds up all of them.
BARRIER_INLINE void sum_bins(__local Shared* shared) {
  for (int part = (int)get_local_id(0); part < BINS / PART_BINS; part += GROUP) {
    int sum = 0;
    for (int k = 0; k < PART_BINS; ++k) sum += shared->histogram[part * PART_BINS + k];
    shared->parts[part] = sum;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// Median of |r| from the histogram, straight within its bin; as a normal deviation.
static inline float median_scale(__local const Shared* shared) {
  int total = 0;
  for (int part = 0; part < BINS / PART_BINS; ++part) total += shared->parts[part];
  const float middle = 0.5f * (float)total;
  int below = 0, part = 0;
  while (part < BINS / PART_BINS - 1 && (float)(below + shared->parts[part]) < middle) {
    below += shared->parts[part];
    ++part;
  }
  int k = part * PART_BINS;
  while (k < BINS - 1 && (float)(below + shared->histogram[k]) < middle) {
    below += shared->histogram[k];
    ++k;
  }
  const float within = (middle - (float)below) / (float)max(shared->histogram[k], 1);
  return 1.4826f * shared->bin * ((float)k + within);
}

// Lane 0: one Gauss–Newton step from the sums, and what the next pass is to do.
static inline void step(__local Shared* shared, const BallTask task, const BallLimits limits) {
  __local float* sums = shared->sums;
  const float count = sums[0];
  const float area =
      compared_area(task, limits) / (shared->coarse ? COARSE_ROWS * COARSE_UNITS : 1);
  if (!(count > SMALLEST_SHARE * area)) {
    shared->status = shared->scale > 0.0f ? STATUS_LOW_CORRELATION : STATUS_OUT_OF_VIEW;
    return;
  }
  const float spread = covariance(sums, 1, 1);
  shared->carried = count;
  if (!shared->coarse) shared->correlation = correlation(shared);
  // The factor takes the place of the regressors' sums; those of r stand behind and stay.
  if (!(spread >= count * limits.min_contrast * limits.min_contrast) ||
      !cholesky(sums, REGRESSORS, SMALLEST_PIVOT)) {
    shared->status = STATUS_NO_TEXTURE;
    return;
  }
  __local const float* right = sums + TRIANGLE(REGRESSORS, 0);
  for (int k = 0; k < REGRESSORS; ++k) shared->solution[k] = right[k];
  cholesky_solve(sums, REGRESSORS, shared->solution);
  float residual = right[REGRESSORS];
  for (int k = 0; k < REGRESSORS; ++k) residual -= shared->solution[k] * right[k];
  const float scale =
      shared->bin > 0.0f ? fmax(median_scale(shared), SMALLEST_SCALE * limits.grey_level) : 0.0f;
  const float change = scale > 0.0f && shared->scale > 0.0f ? log(scale / shared->scale) : 0.0f;
  const float slight = clamp(change, -SAME_SCALE, SAME_SCALE);
  shared->carried = count + slight * (count - sums[NEWTON]);
  shared->variance = fmax(residual + slight * sums[CHANGE], 0.0f) / (shared->carried - REGRESSORS);
  const float stretch = clamp(count / sums[NEWTON], 1.0f, LONGEST_STRETCH);
  for (int k = 0; k < REGRESSORS; ++k) shared->solution[k] *= stretch;
  for (int k = 0; k < LIGHT; ++k) shared->light[k] += shared->solution[k];
  if (!(shared->light[1] > 0.0f)) {
    shared->status = STATUS_LOW_CORRELATION;
    return;
  }
  const float moved = move(shared, task.radius);
  ++shared->steps;
  const float drift =
      fmax(fabs(shared->warp[4] - task.guess_dx), fabs(shared->warp[5] - task.guess_dy));
  const int settled =
      !limits.robust || (shared->scale > 0.0f && scale > 0.0f && fabs(change) <= SAME_SCALE);
  if (shared->moved > 0.0f) {
    shared->pace = clamp(moved / fmax(shared->moved, SHORTEST_STEP_PX), SMALLEST_PACE, 1.0f);
  }
  shared->moved = moved;
  if (!(drift <= 0.5f * task.radius)) {
    shared->status = STATUS_NOT_CONVERGED;
  } else if (!shared->coarse && settled && moved * shared->pace < LEFT_PX) {
    shared->status = STATUS_OK;
  }
  if (shared->bin > 0.0f) shared->scale = scale;
  shared->bin = limits.robust && moved < NEAR_PX
                    ? fmax(sqrt(shared->variance), 0.25f * limits.grey_level) / 32.0f
                    : 0.0f;
  if (shared->coarse && moved < COARSE_PX && (!limits.robust || shared->scale > 0.0f)) {
    shared->coarse = 0;
    shared->moved = 0.0f;  // other pixels, another minimum
  }
}

// Share of the slopes' power that smoothing them once more leaves, from every fourth pixel each
// way: the pictures' noise went through the same Gaussian, and reaches the motion through it.
BARRIER_INLINE float smoothed_share(__global const float* value, const Box box, const BallTask task,
                                    const BallLimits limits, __constant float* taps,
                                    __local float* scratch, __local Shared* shared) {
  if (SMOOTH_RADIUS == 0) return 1.0f;
  const int item = (int)get_local_id(0), reach = SMOOTH_RADIUS;
  const size_t plane = (size_t)limits.height * limits.plane_pitch;
  const int across = (box.x1 - box.x0 + 3) / 4, down = (box.y1 - box.y0 + 3) / 4;
  float power[2] = {0.0f, 0.0f};
  for (int k = item; k < across * down; k += GROUP) {
    const int px = box.x0 + 4 * (k % across), py = box.y0 + 4 * (k / across);
    const float x = (float)px - task.cx, y = (float)py - task.cy;
    if (x * x + y * y >= task.radius * task.radius) continue;
    if (px < reach || py < reach || px + reach >= limits.width || py + reach >= limits.height) {
      continue;
    }
    __global const float* at = value + plane + (size_t)py * limits.plane_pitch + px;
    float smooth_x = 0.0f, smooth_y = 0.0f;
#pragma unroll 1
    for (int j = -reach; j <= reach; ++j) {
#pragma unroll
      for (int i = -reach; i <= reach; ++i) {
        const float weight = taps[abs(i)] * taps[abs(j)];
        smooth_x += weight * at[j * limits.plane_pitch + i];
        smooth_y += weight * at[(size_t)plane + j * limits.plane_pitch + i];
      }
    }
    power[0] += at[0] * at[0] + at[plane] * at[plane];
    power[1] += smooth_x * smooth_x + smooth_y * smooth_y;
  }
  scratch[item] = power[0];
  scratch[REDUCE_PITCH + item] = power[1];
  sum_rows(2, scratch, shared->smoothed);
  return shared->smoothed[1] / shared->smoothed[0];
}

// Lane 0: standard deviations of dx, dy, rotation, exx, exy, eyy for the pixel deviation `scale`:
// each is a sum of two parameters with weights.
static inline void store_deviations(__global BallMotion* out, __local Shared* shared,
                                    const float radius, const float scale) {
  __global float* deviation[] = {&out->dx_sd,  &out->dy_sd,  &out->rot_sd_rad,
                                 &out->exx_sd, &out->exy_sd, &out->eyy_sd};
#if PARAMETERS == 3
  const int parameter[] = {0, 1, 2}, other[] = {0, 1, 2};
  const float weight[] = {1.0f, 1.0f, 1.0f / radius}, other_weight[] = {0.0f, 0.0f, 0.0f};
  out->exx_sd = out->exy_sd = out->eyy_sd = 0.0f;
#else
  const float whole = 1.0f / radius, part = 0.5f / radius;
  const int parameter[] = {0, 3, 2, 1, 2, 5}, other[] = {0, 3, 4, 1, 4, 5};
  const float weight[] = {1.0f, 1.0f, part, whole, part, whole};
  const float other_weight[] = {0.0f, 0.0f, -part, 0.0f, part, 0.0f};
#endif
#pragma unroll 1
  for (int k = 0; k < PARAMETERS; ++k) {
    for (int i = 0; i < REGRESSORS; ++i) shared->solution[i] = 0.0f;
    shared->solution[LIGHT + parameter[k]] += weight[k];
    shared->solution[LIGHT + other[k]] += other_weight[k];
    *deviation[k] = scale * sqrt(cholesky_quadratic(shared->sums, REGRESSORS, shared->solution));
  }
}

static inline void store_motion(__global BallMotion* out, __local const Shared* shared) {
  __local const float* w = shared->warp;
  const float turn = atan2(w[1] - w[2], w[0] + w[3]);
  out->dx = w[4];
  out->dy = w[5];
  out->rot_rad = turn;
#if PARAMETERS == 3
  out->exx = out->exy = out->eyy = 0.0f;
#else
  // A = R U, R the rotation and U symmetric.
  const float c = cos(turn), s = sin(turn);
  out->exx = c * w[0] - s * w[2] - 1.0f;
  out->eyy = s * w[1] + c * w[3] - 1.0f;
  out->exy = 0.5f * (c * w[1] - s * w[3] + s * w[0] + c * w[2]);
#endif
}

static inline void store_failure(__global BallMotion* out) {
  out->dx = out->dy = out->rot_rad = NAN;
  out->exx = out->exy = out->eyy = NAN;
  out->dx_sd = out->dy_sd = out->rot_sd_rad = NAN;
  out->exx_sd = out->exy_sd = out->eyy_sd = NAN;
}

// coefficients, planes: of SplineFrames (prefilter.cl), the former from element `offset` on.
// smooth_taps: (SMOOTH_RADIUS + 1) weights of the pre-smoothing. noise: see warp_noise, and
// in its last element the noise variance of the first picture. mask: weights of the first picture's
// pixels, rows as the planes' (MASKED 1; else not read). One group of GROUP a task.
__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void register_balls(
    __global const float* coefficients, const int offset, __global const float* planes,
    __global const BallTask* tasks, __global BallMotion* motions, const BallLimits limits,
    __constant float* smooth_taps, const float4 noise, __global const float* mask) {
  __local float scratch[REDUCE_SCRATCH];
  __local Shared shared;
  const int item = (int)get_local_id(0);
  const BallTask task = tasks[get_group_id(0)];
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
    // Read before the first work-item can go on to change it.
    const int counted = shared.bin > 0.0f;
    const Box box = disc_box(task, shared.coarse, limits.width, limits.height);
    pass(value, second, mask, task, box, limits, scratch, &shared);
    if (counted) sum_bins(&shared);
    if (item == 0) step(&shared, task, limits);
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  const Box box = disc_box(task, 0, limits.width, limits.height);
  const float share = smoothed_share(value, box, task, limits, smooth_taps, scratch, &shared);
  const float second_noise =
      warp_noise(shared.warp, (float2)(task.cx, task.cy), 0.6f * task.radius, noise, shared.noise);
  if (item != 0) return;
  int status = shared.status;
  if (status == STATUS_RUNNING) status = STATUS_NOT_CONVERGED;
  if (status == STATUS_OK && !(shared.correlation >= limits.min_correlation)) {
    status = STATUS_LOW_CORRELATION;
  }
  __global BallMotion* out = &motions[get_group_id(0)];
  out->status = status;
  out->steps = shared.steps;
  out->correlation = shared.correlation;
  out->residual = sqrt(shared.variance);
  out->used = shared.carried / compared_area(task, limits);
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
}
