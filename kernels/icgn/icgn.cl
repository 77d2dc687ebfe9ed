#include "kernels/config.h"
#include "kernels/linalg.h"
#include "kernels/reduce.h"
#include "kernels/spline.h"
#include "kernels/status.h"
#include "kernels/types.h"
#include "kernels/warp.h"

// Sub-pixel registration of square windows by inverse-compositional Gauss–Newton with an affine
// warp and the ZNSSD criterion (Baker and Matthews 2004; Pan, Li and Tong 2013).
//
// The window f of the first frame is laid on the second frame's spline g through
// W(X) = t + A X, X from the window's centre. In each step the least-squares regression
//   g(W(X)) ≈ offset + gain · (f + ∇fᵀ D(X) δ),  D δ = (du + ux X + uy Y, dv + vx X + vy Y)
// gives the increment δ, and W becomes W ∘ (1 + Dδ)⁻¹. Offset and gain are free in the
// regression, so that the minimum is that of ZNSSD exactly. Its normal matrix holds f and ∇f
// alone: it is made and factorised once.

#define CHUNKS ((WINDOW_PX + VECTOR - 1) / VECTOR) /* of a row, VECTOR pixels each */
#define UNITS (WINDOW_PX * CHUNKS)
#define HALF_PX (0.5f * (WINDOW_PX - 1))
#define COLUMNS 8 /* of the regression: 1, f, fx, fx X, fx Y, fy, fy X, fy Y; X, Y over HALF_PX */
#define SUMS (COLUMNS * (COLUMNS + 1) / 2)

// A step after which no pixel of the window is further than this from where further ones would take
// it is the last. What is left of a step is taken to be the share of it that the step before left,
// and a tenth where there was none.
#define LEFT_PX 5e-5f
#define UNKNOWN_PACE 0.1f
// Smallest pivot of the normal matrix relative to its diagonal: below, there is no texture in
// some direction. A hundred roundings.
#define SMALLEST_PIVOT 1e-5f
#define ROUNDING_VARIANCE (1.0f / 12.0f) /* of a pixel, grey levels */
// kInterpolationPx of host/dic/frames/spline_taps.h.
#define INTERPOLATION_PX 0.02f
// Mean square of a pixel's place along an axis in a whole window, over HALF_PX.
#define MEAN_SQUARE ((WINDOW_PX + 1.0f) / (3.0f * (WINDOW_PX - 1.0f)))

// Of a window that is still at work.
#define STATUS_RUNNING (-1)
#define STATUS_NO_SEED (-2) /* the window stays as it is */
#define STATUS_LOST (-3)    /* the same, unless there is nothing that could have been found */

// What the work-items of a group share about their window.
typedef struct Shared {
  float warp[6];
  float seed_u, seed_v;
  float origin;  // grey level taken off both pictures, so that sums of squares keep their digits
  float correlation, gain, variance;
  float moved;  // by the last step, px; 0: none yet
  int status;
  float normal[SUMS];
  // Cholesky factors: of the normal matrix, and of its part that is texture.
  float factor[SUMS], texture[SUMS];
  float doubt_variance;      // of a pixel: noise, and what interpolation adds
  float slope_variance;      // of the slopes that this makes
  int singular[2];           // what has no such factor
  float right[COLUMNS + 1];  // regressors times g, and g²
  float solution[COLUMNS];
  float row[2][COLUMNS], spread[2];  // see spreads
  float noise[NOISE_PLACES * NOISE_PLACES];
} Shared;

// What noise leaves of a window.
typedef struct Doubt {
  float pixel_variance;  // of the noise, as far as it is known before
  float slope_gain;      // variance of a slope in units of a pixel's
  float max_sd_px;       // expected of either component: beyond, there is no texture
} Doubt;

// One unit of the template: VECTOR pixels of a row.
typedef struct Pixels {
  REAL x, y;  // from the window's centre, px
  REAL weight;
  REAL column[COLUMNS];
} Pixels;

static inline void load_pixels(__global const float* value, const int plane, const int plane_pitch,
                               const int unit, const float origin, const float4 disc,
                               const Window window, Pixels* p) {
  const int row = unit / CHUNKS, first = (unit % CHUNKS) * VECTOR;
  const int at = row * plane_pitch + first;
  p->x = LANE_NUMBERS + ((float)first - HALF_PX);
  p->y = (REAL)(row - HALF_PX);
  const REAL from_x = p->x + ((float)window.x0 + HALF_PX - disc.x);
  const REAL from_y = p->y + ((float)window.y0 + HALF_PX - disc.y);
  const REAL one = 1.0f, none = 0.0f;
  p->weight = (p->x <= HALF_PX) && (from_x * from_x + from_y * from_y <= disc.z) ? one : none;
  const REAL w = p->weight, x = p->x * (1.0f / HALF_PX), y = p->y * (1.0f / HALF_PX);
  const REAL slope_x = w * LOAD_REAL(value + plane + at);
  const REAL slope_y = w * LOAD_REAL(value + 2 * plane + at);
  p->column[0] = w;
  p->column[1] = w * (LOAD_REAL(value + at) - origin);
  p->column[2] = slope_x;
  p->column[3] = slope_x * x;
  p->column[4] = slope_x * y;
  p->column[5] = slope_y;
  p->column[6] = slope_y * x;
  p->column[7] = slope_y * y;
}

// Of the normal matrix, the mean share that noise has whose slopes have the variance `slope`: the
// window's pixels are taken to lie evenly about its centre.
static inline float noise_share(const int column, const float count, const float slope) {
  return column < 2 ? 0.0f : count * slope * (column == 2 || column == 5 ? 1.0f : MEAN_SQUARE);
}

// Into spread: variance of displacement components 0 (u) and 1 (v) per unit of the variance of the
// pictures' difference. The registration's equations read (T + K) δ = Σ ∇f (g − f) with T the
// texture's and K the noise's share of the information, but their mean moves with T δ alone: the
// variance is that of T⁻¹ (T + K) T⁻¹. Every work-item must call it.
BARRIER_INLINE void spreads(__local Shared* shared) {
  for (int c = (int)get_local_id(0); c < 2; c += GROUP) {
    __local float* row = shared->row[c];
    for (int k = 0; k < COLUMNS; ++k) row[k] = k == 2 + 3 * c ? 1.0f : 0.0f;
    cholesky_solve(shared->texture, COLUMNS, row);
    float sum = row[2 + 3 * c];
    for (int k = 0; k < COLUMNS; ++k) {
      sum += noise_share(k, shared->normal[0], shared->slope_variance) * row[k] * row[k];
    }
    shared->spread[c] = sum;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// Lane 0: what can be told before the second picture is looked at.
static inline void judge_texture(__local Shared* shared, const float min_contrast,
                                 const Doubt doubt) {
  const float count = shared->normal[0];
  const float contrast = shared->normal[TRIANGLE(1, 1)] -
                         shared->normal[TRIANGLE(1, 0)] * shared->normal[TRIANGLE(1, 0)] / count;
  const float least = min_contrast * min_contrast;
  const float most = doubt.max_sd_px * doubt.max_sd_px;
  const float sd_u = 2.0f * shared->doubt_variance * shared->spread[0];
  const float sd_v = 2.0f * shared->doubt_variance * shared->spread[1];
  if (count < 0.5f * WINDOW_PX * WINDOW_PX) {
    shared->status = STATUS_MASKED;
  } else if (!(contrast >= count * (least + doubt.pixel_variance)) || shared->singular[0] ||
             shared->singular[1] || !(sd_u <= most && sd_v <= most)) {
    shared->status = STATUS_NO_TEXTURE;
  }
}

// The normal matrix of the window, and its factors where it has them.
BARRIER_INLINE void make_template(__global const float* value, const int plane,
                                  const int plane_pitch, const float4 disc, const Window window,
                                  const float min_contrast, const Doubt doubt,
                                  __local float* scratch, __local Shared* shared) {
  const int item = (int)get_local_id(0);
  REAL sums[SUMS];
  for (int k = 0; k < SUMS; ++k) sums[k] = 0.0f;
  for (int base = 0; base < UNITS; base += GROUP) {
    if (base + item < UNITS) {
      Pixels p;
      load_pixels(value, plane, plane_pitch, base + item, shared->origin, disc, window, &p);
#pragma unroll
      for (int i = 0; i < COLUMNS; ++i) {
#pragma unroll
        for (int j = 0; j <= i; ++j) sums[TRIANGLE(i, j)] += p.column[i] * p.column[j];
      }
    }
  }
  GROUP_SUMS(sums, SUMS, scratch, shared->normal)
  const float slopes = shared->normal[TRIANGLE(2, 2)] + shared->normal[TRIANGLE(5, 5)];
  const float variance =
      doubt.pixel_variance + INTERPOLATION_PX * INTERPOLATION_PX * slopes / shared->normal[0];
  const float slope_variance = variance * doubt.slope_gain;
  for (int which = item; which < 2; which += GROUP) {
    __local float* matrix = which == 0 ? shared->factor : shared->texture;
    for (int k = 0; k < SUMS; ++k) matrix[k] = shared->normal[k];
    for (int k = 2; which == 1 && k < COLUMNS; ++k) {
      matrix[TRIANGLE(k, k)] -= noise_share(k, shared->normal[0], slope_variance);
    }
    shared->singular[which] = !cholesky(matrix, COLUMNS, SMALLEST_PIVOT);
  }
  if (item == 0) {
    shared->doubt_variance = variance;
    shared->slope_variance = slope_variance;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  spreads(shared);
  if (item == 0) judge_texture(shared, min_contrast, doubt);
  barrier(CLK_LOCAL_MEM_FENCE);
}

// False where a corner of the warped window leaves the picture; the warp is affine, so the corners
// tell for all pixels.
static inline int in_view(__local const Shared* shared, const Window window, const int width,
                          const int height) {
  const float x = (float)window.x0 + HALF_PX + shared->warp[4];
  const float y = (float)window.y0 + HALF_PX + shared->warp[5];
  const float reach_x = HALF_PX * (fabs(shared->warp[0]) + fabs(shared->warp[1]));
  const float reach_y = HALF_PX * (fabs(shared->warp[2]) + fabs(shared->warp[3]));
  return x - reach_x >= 0.0f && x + reach_x <= (float)(width - 1) && y - reach_y >= 0.0f &&
         y + reach_y <= (float)(height - 1);
}

// W ∘ (1 + Dδ)⁻¹. Returns the largest displacement of a pixel by δ (an upper bound), px.
static inline float compose(__local Shared* shared) {
  const float by_gain = 1.0f / shared->gain, by_half = by_gain / HALF_PX;
  __local const float* s = shared->solution;
  const float du = s[2] * by_gain, ux = s[3] * by_half, uy = s[4] * by_half;
  const float dv = s[5] * by_gain, vx = s[6] * by_half, vy = s[7] * by_half;
  warp_compose_inverse(shared->warp, 1.0f + ux, uy, vx, 1.0f + vy, du, dv);
  const float move_x = fabs(du) + HALF_PX * (fabs(ux) + fabs(uy));
  const float move_y = fabs(dv) + HALF_PX * (fabs(vx) + fabs(vy));
  return fmax(move_x, move_y);
}

// Lane 0: one Gauss–Newton step from the sums over the second picture.
static inline void step(__local Shared* shared, const Window window, const int width,
                        const int height) {
  const float count = shared->normal[0];
  const float mean_f = shared->normal[TRIANGLE(1, 0)] / count;
  const float mean_g = shared->right[0] / count;
  const float ff = shared->normal[TRIANGLE(1, 1)] - count * mean_f * mean_f;
  const float gg = shared->right[COLUMNS] - count * mean_g * mean_g;
  const float fg = shared->right[1] - count * mean_f * mean_g;
  shared->correlation = fg / sqrt(ff * gg);
  for (int k = 0; k < COLUMNS; ++k) shared->solution[k] = shared->right[k];
  cholesky_solve(shared->factor, COLUMNS, shared->solution);
  shared->gain = shared->solution[1];
  if (!(shared->gain > 0.0f)) {
    shared->status = STATUS_LOW_CORRELATION;
    return;
  }
  float residual = shared->right[COLUMNS];
  for (int k = 0; k < COLUMNS; ++k) residual -= shared->solution[k] * shared->right[k];
  shared->variance = fmax(residual, 0.0f) / (count - COLUMNS);
  const float moved = compose(shared);
  const float pace = shared->moved > 0.0f ? fmin(moved / shared->moved, 1.0f) : UNKNOWN_PACE;
  shared->moved = moved;
  if (!(fabs(shared->warp[4] - shared->seed_u) <= HALF_PX &&
        fabs(shared->warp[5] - shared->seed_v) <= HALF_PX)) {
    shared->status = STATUS_NOT_CONVERGED;
  } else if (!in_view(shared, window, width, height)) {
    shared->status = STATUS_OUT_OF_VIEW;
  } else if (moved * pace < LEFT_PX) {
    shared->status = STATUS_OK;
  }
}

static inline void store(__global WindowMotion* motion, __local Shared* shared,
                         const float min_correlation, const float second_noise) {
  int status = shared->status;
  if (status == STATUS_RUNNING) status = STATUS_NOT_CONVERGED;
  if (status == STATUS_OK && !(shared->correlation >= min_correlation)) {
    status = STATUS_LOW_CORRELATION;
  }
  motion->status = status;
  motion->correlation = shared->correlation;
  if (status == STATUS_OK) {
    // Both frames' noise shifts the result alike, but the residual holds the second one's after
    // interpolation. Pixels are rounded to whole grey levels, which a residual need not show.
    const float variance = 2.0f * fmax(shared->variance / (1.0f + second_noise), ROUNDING_VARIANCE);
    motion->u = shared->warp[4];
    motion->v = shared->warp[5];
    motion->u_sd = sqrt(variance * shared->spread[0]) / shared->gain;
    motion->v_sd = sqrt(variance * shared->spread[1]) / shared->gain;
    motion->ux = shared->warp[0] - 1.0f;
    motion->uy = shared->warp[1];
    motion->vx = shared->warp[2];
    motion->vy = shared->warp[3] - 1.0f;
  } else {
    motion->u = motion->v = motion->u_sd = motion->v_sd = NAN;
    motion->ux = motion->uy = motion->vx = motion->vy = NAN;
  }
}

static inline void start(__local Shared* shared, const Window window, const WindowMotion seed,
                         const int width, const int height) {
  warp_start(shared->warp, seed.u, seed.v, window.guess_rot_rad);
  shared->correlation = NAN;
  shared->moved = 0.0f;
  const int inside = window.x0 >= 0 && window.y0 >= 0 && window.x0 + WINDOW_PX <= width &&
                     window.y0 + WINDOW_PX <= height;
  if (seed.status != STATUS_OK) {
    const int was_sought = seed.status == STATUS_LOW_CORRELATION ||
                           seed.status == STATUS_AT_SEARCH_EDGE ||
                           seed.status == STATUS_NOT_CONVERGED;
    shared->status = inside && was_sought ? STATUS_LOST : STATUS_NO_SEED;
  } else {
    shared->status =
        inside && in_view(shared, window, width, height) ? STATUS_RUNNING : STATUS_OUT_OF_VIEW;
  }
  shared->seed_u = seed.u;
  shared->seed_v = seed.v;
}

// Refines every window whose seed is ok (u, v of `motions`; the rotation of the window's guess) in
// place; of those that were sought in vain it tells which have no texture. coefficients, planes: of
// SplineFrames (prefilter.cl), the former from element `offset` on. discs: (slots) centre x, y and
// squared radius; pixels of the first frame outside carry no weight. noise: see warp_noise; w:
// variance of a slope in units of a pixel's. pixel_variance: of the pictures' noise. One group of
// GROUP a window.
__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void refine_windows(
    __global const float* coefficients, const int offset, __global const float* planes,
    const int width, const int height, const int pitch, const int plane_pitch,
    __global const float4* discs, __global const Window* windows, __global WindowMotion* motions,
    const float min_contrast, const float min_correlation, const int max_iterations,
    const float4 noise, const float pixel_variance, const float max_sd_px) {
  __local float scratch[REDUCE_SCRATCH];
  __local Shared shared;
  const int item = (int)get_local_id(0);
  const Window window = windows[get_group_id(0)];
  if (item == 0) start(&shared, window, motions[get_group_id(0)], width, height);
  barrier(CLK_LOCAL_MEM_FENCE);
  const int plane = height * plane_pitch;
  __global const float* value =
      planes + (size_t)window.first * 3 * plane + window.y0 * plane_pitch + window.x0;
  const float4 disc = discs[window.first];
  if (shared.status == STATUS_RUNNING || shared.status == STATUS_LOST) {
    if (item == 0) shared.origin = value[(WINDOW_PX / 2) * plane_pitch + WINDOW_PX / 2];
    barrier(CLK_LOCAL_MEM_FENCE);
    const Doubt doubt = {pixel_variance, noise.w, max_sd_px};
    make_template(value, plane, plane_pitch, disc, window, min_contrast, doubt, scratch, &shared);
  }
  __global const float* second = coefficients + offset +
                                 (size_t)window.second * (height + 2 * SPLINE_PAD) * pitch +
                                 SPLINE_PAD * pitch + SPLINE_PAD;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    if (shared.status != STATUS_RUNNING) break;
    // Whole pixels of the displacement are taken off, so that floats keep all their digits for the
    // position within the window.
    const float whole_x = rint(shared.warp[4]), whole_y = rint(shared.warp[5]);
    const float rest_x = HALF_PX + (shared.warp[4] - whole_x);
    const float rest_y = HALF_PX + (shared.warp[5] - whole_y);
    __global const float* origin =
        second + (window.y0 + (int)whole_y) * pitch + window.x0 + (int)whole_x;
    REAL sums[COLUMNS + 1];
    for (int k = 0; k <= COLUMNS; ++k) sums[k] = 0.0f;
    for (int base = 0; base < UNITS; base += GROUP) {
      if (base + item < UNITS) {
        Pixels p;
        load_pixels(value, plane, plane_pitch, base + item, shared.origin, disc, window, &p);
        const REAL x = rest_x + shared.warp[0] * p.x + shared.warp[1] * p.y;
        const REAL y = rest_y + shared.warp[2] * p.x + shared.warp[3] * p.y;
        const REAL zero = 0.0f;
        const REAL g = p.weight > 0.0f ? spline_sample(origin, pitch, x, y) - shared.origin : zero;
#pragma unroll
        for (int k = 0; k < COLUMNS; ++k) sums[k] += p.column[k] * g;
        sums[COLUMNS] += g * g;
      }
    }
    GROUP_SUMS(sums, COLUMNS + 1, scratch, shared.right)
    if (item == 0) step(&shared, window, width, height);
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (shared.status == STATUS_NO_SEED || shared.status == STATUS_LOST) return;
  const float second_noise =
      warp_noise(shared.warp, (float2)(HALF_PX, HALF_PX), HALF_PX, noise, shared.noise);
  if (item == 0) store(&motions[get_group_id(0)], &shared, min_correlation, second_noise);
}
