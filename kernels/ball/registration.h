// What the parts of a ball's registration (rigid.cl) share: its columns and sums, the limits of its
// steps, the state of a group, and the pixels of the disc in the order in which they are seen.
#ifndef IMPACTDIC_KERNELS_BALL_REGISTRATION_H_
#define IMPACTDIC_KERNELS_BALL_REGISTRATION_H_

#include "kernels/config.h"
#include "kernels/linalg.h"
#include "kernels/reduce.h"
#include "kernels/spline.h"
#include "kernels/status.h"
#include "kernels/types.h"
#include "kernels/warp.h"
#if SHAPED
#include "kernels/ball/sight.h"
#endif

#define SPHERE 5 /* PARAMETERS of a sphere: u, v and three turns */
#define LIGHT 4  /* 1, f, f X/R, f Y/R */
#define MOVES (PARAMETERS + FREE_RADIUS + FREE_DISTANCE + 2 * FREE_CENTRE)
#define ALONG_X LIGHT /* columns of shifts, which are slopes */
#define ALONG_Y (LIGHT + (PARAMETERS == 6 ? 3 : 1))
#define REGRESSORS (LIGHT + MOVES) /* and the slopes by the parameters over the radius */
#define COLUMNS (REGRESSORS + 1)   /* and r */
#define PRODUCTS (COLUMNS * (COLUMNS + 1) / 2)
#define NEWTON PRODUCTS        /* then: the weights' share of Newton's matrix, see biweight */
#define CHANGE (PRODUCTS + 1)  /* what w r² gains by the logarithm of the scale */
#define TEXTURE (PRODUCTS + 2) /* the slopes' power with no robust weights */
#define SUMS (PRODUCTS + 3)
// Bends (bend.h) are taken off where nothing but the motion is asked: what tells the radius, the
// distance or the centre is a pair that turns by more than their first order holds for.
#define BENDS (PARAMETERS == SPHERE && MOVES == PARAMETERS)
#define BINS 256
#define PART_BINS 16
#define ROUNDING_VARIANCE (1.0f / 12.0f)

// A step after which no pixel is further than this from where further ones would take it is the
// last: far below what noise of one grey level does to a ball. What is left of a step is taken to
// be its share that the step before it had left, at least the first of these, and the second where
// there was no such step. Under a lamp the pictures change with the steps, which leave more.
#if LIT
#define LEFT_PX 6e-6f
#else
#define LEFT_PX 6e-5f
#endif
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
// Pre-smoothing makes neighbouring pixels err alike: what many pixels tell has this many times the
// variance that one pixel's residual shows.
#define ALIKE 1.7f
#define SMALLEST_PIVOT 1e-6f
#define SMALLEST_SHARE 0.2f /* of the disc, in view and with weight */
// Share of the slopes' power that robust weights have to leave: where most edges differ from those
// of the other picture, as where one of the two is over-exposed, the rest tells another motion.
#define LEAST_KEPT 0.6f

// A sphere's pixel counts from the first of these cosines of its surface's angle to the line of
// sight on, wholly from the second on, in the first or the second picture, whichever is less:
// beyond, foreshortening leaves no texture.
#define LEAST_DEPTH 0.2f
// SPHERE_SHARE: Σ of those weights over the whole disc, in areas of it. What is near the rim tells
// most of a motion, and where bends are taken off it counts.
#if BENDS
#define FULL_DEPTH 0.4f
#define SPHERE_SHARE 0.91f
#else
#define FULL_DEPTH 0.5f
#define SPHERE_SHARE 0.87f
#endif
// And half as much where the change of the blur, its variance times C of blur.h, has this sum of
// squares, px⁴.
#define BLUR_CHANGE 4.5f
// Pixels across and down whose errors are taken to be their own: beyond the size of a speckle.
#define BLOCK_X 16
#define BLOCK_Y 8

// A sphere whose radius is found is at most so many radii of its disc.
#define LARGEST_SPHERE 1.5f
// A ball is not taken to be seen from nearer than twice its disc's radius, nor its rays to open by
// more than from four times that.
#define NEAREST 0.5f
#define WIDEST (-0.25f)

#define STATUS_RUNNING (-1) /* of a ball that is still at work */

// What the work-items of a group share about their ball.
typedef struct Shared {
  float warp[6];
#if PARAMETERS == SPHERE
  float turn[9];           // from the first to the second picture; x right, y down, z to camera
  float bent[REGRESSORS];  // what bends give to a step's right side
  float inverse[MOVES * REGRESSORS];  // rows of the inverse of the normal matrix
  float radius;                       // of the sphere
  float centre[2];                    // of the sphere in the first picture, px
  float told;                         // weight of the centre that was told, see tell_centre
#if LIT
  BallLight lamp;
#endif
#if SHAPED
  Seen seen[2];  // in the first and the second picture
#if FREE_DISTANCE
  float away[2][2];  // from the optical axis to the centre, px: over the distance, seen's aside
#endif
#endif
#endif
  float origin;                 // grey level taken off both pictures
  float light[LIGHT];           // coefficients of the light's regressors so far
  float scale;                  // of the weights, 0: all equal
  float bin;                    // width of a bin of the histogram, 0: none is made
  float correlation, variance;  // at the last step
  float carried;                // sum of weights
  float kept;                   // share of the slopes' power that robust weights leave
  float moved, pace;            // of the last step, px; see LEFT_PX
  float stretch;                // of the last step; see LONGEST_STRETCH
  int coarse;                   // not 0: the next pass does not see all pixels
  int status, steps;
  float sums[SUMS];
  float solution[REGRESSORS];
  float scores[TRIANGLE(REGRESSORS, 0)];  // Σ over blocks of their scores' products
  float noise[NOISE_PLACES * NOISE_PLACES];
  float smoothed[2];
  int histogram[BINS];
  int parts[BINS / PART_BINS];
} Shared;

// What is compared has this area, px: the disc, or the mask's pixels in it.
static inline float compared_area(const BallTask task, const BallLimits limits) {
  const float disc =
      limits.mask_area > 0.0f ? limits.mask_area : 3.14159265f * task.radius * task.radius;
#if PARAMETERS == SPHERE
  return SPHERE_SHARE * disc;
#else
  return disc;
#endif
}

// What a pixel of a sphere counts at this cosine of its surface's angle to the line of sight.
static inline REAL seen_share(const REAL cosine) {
  return clamp((cosine - LEAST_DEPTH) * (1.0f / (FULL_DEPTH - LEAST_DEPTH)), (REAL)0.0f,
               (REAL)1.0f);
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

#endif  // IMPACTDIC_KERNELS_BALL_REGISTRATION_H_
