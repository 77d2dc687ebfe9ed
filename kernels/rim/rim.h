// What the host and follow.cl share: the rims to be followed, the numbers that they are followed
// by, and what comes out. 4-byte scalars only, no pointers.
#ifndef IMPACTDIC_KERNELS_RIM_H_
#define IMPACTDIC_KERNELS_RIM_H_

#include "kernels/types.h"

#ifndef __OPENCL_C_VERSION__
namespace impactdic {
#endif

// Samples of a line, of which so many lie inside the rim; samples of a deep line behind them.
#define RIM_SAMPLES 7
#define RIM_INSIDE 3
#define RIM_DEEP 8
// Kinds of lines; sectors of the levels and of the lines.
#define RIM_KINDS 8
#define RIM_LEVEL_SECTORS 24
#define RIM_SECTORS 48

// A rim model: RIM_MODEL_HEAD numbers (ln p of a stray, and from RIM_KINDS on the kinds' shares),
// and for each of 2·RIM_MODEL_REACH + 1 excesses RIM_TABLE numbers: two quadratics in the profile,
// ln p and its slope (RIM_FORMS rows of RIM_KINDS, then their offsets), and the informations.
#define RIM_MODEL_HEAD 16
#define RIM_MODEL_REACH 8
#define RIM_FORMS (1 + RIM_SAMPLES + RIM_SAMPLES * (RIM_SAMPLES + 1) / 2)
#define RIM_FORM ((RIM_FORMS + 1) * RIM_KINDS)
#define RIM_TABLE (2 * RIM_FORM + RIM_KINDS)
#define RIM_MODEL (RIM_MODEL_HEAD + (2 * RIM_MODEL_REACH + 1) * RIM_TABLE)

// Numbers of a line while its rim is followed: of the line, of one that is kept, of its evidence.
#define RIM_ROOM (2 * (3 + RIM_SAMPLES) + 1 + 3 * RIM_KINDS)

// A quarter of a rim: lines along v, one every so many u. u is along the rows and v along the
// columns, or the other way round.
typedef struct RimQuarter {
  float a, b, c;       // the conic a u² + 2b uv + c v² = 1 about the centre
  float u0, v0;        // the first line's u and the pixel from which v is told, from the centre
  float u_step, side;  // side: the sign of v
  float least, most;   // v of pixels that have their neighbours
  idic_int turn;       // 0 … 3
  idic_int origin;     // element of the picture at the first line's u and v 0
  idic_int to_u;       // elements from a line to the next one
  idic_int to_v;       // elements from a pixel to the next one along v
  idic_int lines;      // how many there are
} RimQuarter;

// A rim to be followed from where it is expected.
typedef struct RimTask {
  idic_int slot;  // of the picture
  RimQuarter quarter[4];
  idic_int cast;          // lines in the picture or not
  float sign;             // of grey levels, that makes the ball bright
  float step, deep_step;  // px, of the samples and of the deep ones
  float r, e1, e2;        // of the rim that the lines are cast about, px
  idic_int oval;          // 1 where an ellipse is fitted first
  // What is known: the radius less the one above and its deviation (0: not known), px; the unit
  // vector of e1 and e2 that the long axis has (both 0: not known).
  float radius_off, radius_sd, axis1, axis2;
} RimTask;

// Settings of host/circle/settings, by their names there.
typedef struct RimNumbers {
  // Levels.
  float noise_per_median, rise_rank, bright, bright_noise, bright_least;
  float ground_noise, ground_least, ground_tolerance, least_contrast;
  float noise_alike, noise_even;
  float below, below_weight, no_shading[3];
  float window_first, window_next, window_noise, window_least, held;
  idic_int least_deep, noise_apart, envelope_passes;
  // Clear lines.
  float clear_contrast, clear_contrast_noise, clear_tolerance, clear_noise;
  float nothing, nothing_noise, gap_of_rim;
  idic_int beside, beside_hidden;
  // The lines, and the fit.
  float last_turn, narrow;
  float reach, settled, newton, there, fine_from, fine_over, near, relinearise, share_worth;
  float common_px, transverse, round_px, axis_tilt, axis_px, least_radius_sd;
  idic_int rounds, steps, points_per_parameter, least_lines, deep_every, preview_every;
} RimNumbers;

// A fit of one shape: its last corrections of (x, y, R, e1, e2), px, those before its last step,
// at which the sums are, and the sums over all lines (host/circle/rim/line_sums.h), whose waves are
// those of 1, cos φ, sin φ … cos 4φ, sin 4φ, by steps of the lines.
typedef struct RimShape {
  idic_int ok;
  float delta[5], before[5];
  float score[5], information[9], hessian[9];
  float kinds[RIM_KINDS], shares[RIM_KINDS];
  float scatter, far;
  float sector_score[RIM_SECTORS], sector_hessian[RIM_SECTORS];
  idic_int sector_points[RIM_SECTORS];
} RimShape;

// What a task's lines have shown. `lines`: kept, 0 where nothing was fitted. widest_gap: between
// two kept ones, where it is wider than ink makes it, rad.
typedef struct RimFound {
  idic_int lines, breaks;
  float noise, usual, widest_gap;
  float ground[RIM_LEVEL_SECTORS], light[5];
  RimShape oval, circle;
} RimFound;

#ifndef __OPENCL_C_VERSION__
}  // namespace impactdic
#endif
#endif  // IMPACTDIC_KERNELS_RIM_H_
