// Plain data that host and kernels share, byte for byte: 4-byte scalars only, no pointers.
#ifndef IMPACTDIC_KERNELS_TYPES_H_
#define IMPACTDIC_KERNELS_TYPES_H_

#ifdef __OPENCL_C_VERSION__
typedef int idic_int;
#else
#include <cstdint>
namespace impactdic {
using idic_int = std::int32_t;
#endif

// One interrogation window to be found again: its first pixel (x0, y0) in frame slot `first`
// (its centre is x0 + (window − 1)/2), and where to look for it in frame slot `second`: displaced
// by about (guess_u, guess_v) px and turned by about guess_rot_rad (counter-clockwise on screen).
typedef struct Window {
  idic_int first, second;
  idic_int x0, y0;
  idic_int guess_u, guess_v;
  float guess_rot_rad;
} Window;

// One window's result; NaN where it could not be measured. Displacement of the window's centre in
// px from the first to the second frame, x right, y down. sd: one standard deviation, from the
// residual between the two pictures. correlation: ZNCC at the result, −1 … 1. peak_ratio: highest
// peak of the correlation map over the highest other local maximum more than 2 px away from it
// along x or y; at most 1000, which also stands for there being none. ux … vy: the
// displacement's gradient ∂u/∂x, ∂u/∂y, ∂v/∂x, ∂v/∂y (0 where the method has none).
// status: a WindowStatus (host/dic/field.h).
typedef struct WindowMotion {
  float u, v;
  float u_sd, v_sd;
  float correlation, peak_ratio;
  float ux, uy, vx, vy;
  idic_int status;
} WindowMotion;

// The highest value of a correlation map, `value` at the displacement (shift_x, shift_y) px, and
// the coefficients of the quintic spline about it, row by row, −3 … 3 lags away; (start_x,
// start_y): where parabolas through its neighbours have their peak, px from it. second: the highest
// other peak (see peak_ratio). status: ok, or why there is none. The spline goes through the
// PEAK_PATCH_PX² values about the peak, or as many of them as the lags reach.
#define PEAK_PATCH_PX 13
#define PEAK_NEAR 7
typedef struct CorrelationPeak {
  idic_int status;
  idic_int shift_x, shift_y;
  float start_x, start_y;
  float value, second;
  float coefficients[PEAK_NEAR * PEAK_NEAR];
} CorrelationPeak;

// Weights that take the values of a patch's row or column to coefficients: for each of the
// PEAK_PATCH_PX + 1 numbers of values n and PEAK_PATCH_PX places p of the peak among them,
// PEAK_PATCH_PX rows (one for each value, zero from n on) of PEAK_WEIGHTS (one for each
// coefficient, and a zero).
#define PEAK_WEIGHTS 8

// The highest value of the circular correlation of a pair of equal windows, at (x, y) of it, and
// its neighbours left, right, above, below; energies of both windows about their means, grey
// levels².
#define EQUAL_CROSS 5
typedef struct EqualPeak {
  idic_int x, y;
  float cross[EQUAL_CROSS];
  float energy[2];
} EqualPeak;

// How a sphere is seen in both pictures, where it is not round or not seen by parallel rays; all 0
// where it is. by_distance: one over the camera's distance from its centre, 1/px, a px being one of
// the sphere at its centre. first_x, first_y: from the optical axis to the centre in the first
// picture over the distance, x right, y down; second_x, second_y: the same in the second one, of a
// ball that has not moved: dx, dy times by_distance are added. first, second: the stretch in the
// picture's plane that makes the compressed ball of a round one of ball_radius, less one: xx, xy,
// yy.
typedef struct BallSight {
  float by_distance;
  float first_x, first_y, second_x, second_y;
  float first[3], second[3];
} BallSight;

// The light on a sphere, fixed to the camera: the level of bare paint where the surface has the
// normal (x, y, z), x right, y down, z towards the camera,
//   ambient + max(0, lamp . n)
// and at least `least`, > 0. In any unit: only ratios count. All 0 where it is not known.
typedef struct BallLight {
  float ambient, lamp[3], least;
} BallLight;

// One ball to be followed from frame slot `first` to frame slot `second`: its centre (cx, cy) and
// the radius of the disc to be compared, px, in the first frame, and a guess of its motion. Of a
// sphere also its radius, px, and the guess is a rotation vector in the camera's axes, X right, Y
// up, Z towards the camera, whose last component is guess_rot_rad; and the variance of what blurs
// both pictures, px² (kernels/ball/blur.h), and the light on it, where that is known. centre_sd:
// deviation of cx and of cy, px, where the centre is to be found along with the motion.
typedef struct BallTask {
  idic_int first, second;
  float cx, cy, radius;
  float guess_dx, guess_dy, guess_rot_rad;
  float ball_radius, blur, centre_sd;
  float guess_rot_x_rad, guess_rot_y_rad;
  BallSight sight;
  BallLight light;
} BallTask;

// The ball's motion from the first to the second frame; NaN where it could not be measured.
// dx, dy: displacement of the centre, px, x right, y down. rot_rad: counter-clockwise on screen.
// exx, exy, eyy: strain of the picture (right stretch tensor less one), in image axes of the first
// frame; 0 where the registration is rigid. *_sd: one standard deviation. correlation: ZNCC at the
// result. residual: rms difference of the pictures, grey levels. used: share of the disc that
// carried weight. status: a WindowStatus (host/dic/field.h). steps: Gauss–Newton steps taken.
// Of a sphere (rot_x_rad, rot_y_rad, rot_rad) is the rotation vector, at most pi long, in the
// camera's axes (X right, Y up, Z towards the camera), and `covariance` the lower triangle, row by
// row, of dx, dy and the small turns about X, Y and Z of the first picture; 0 of a flat ball. Its
// radius, px, one over the camera's distance, 1/px, and its centre in the first picture, px, as
// given (deviation 0) or found.
typedef struct BallMotion {
  float dx, dy, rot_rad;
  float exx, exy, eyy;
  float dx_sd, dy_sd, rot_sd_rad;
  float exx_sd, exy_sd, eyy_sd;
  float correlation, residual, used;
  idic_int status, steps;
  float rot_x_rad, rot_y_rad;
  float covariance[15];
  float ball_radius, ball_radius_sd;
  float by_distance, by_distance_sd;
  float cx, cy, cx_sd, cy_sd;
} BallMotion;

// What does not change from ball to ball.
typedef struct BallLimits {
  idic_int width, height, pitch, plane_pitch;  // of SplineFrames
  idic_int max_steps;
  idic_int robust;        // not 0: Tukey's weights
  float grey_level;       // of 255, in grey levels of the file
  float min_contrast;     // rms, grey levels of the file
  float min_correlation;  // ZNCC
  float mask_area;        // of a mask that is the body, px; else 0
  idic_int mask_pitch;    // of the mask's rows; 0: no mask
} BallLimits;

// One ball whose turn is sought between frame slots `first` and `second`: its centre in each, and
// the radii between which it is compared, px.
typedef struct RingTask {
  idic_int first, second;
  float cx_first, cy_first, cx_second, cy_second;
  float inner, outer;
} RingTask;

// One sphere whose turn is sought between frame slots `first` and `second`: its centre in each and
// its radius, px.
typedef struct SphereSearchTask {
  idic_int first, second;
  float cx_first, cy_first, cx_second, cy_second;
  float radius;
} SphereSearchTask;

#ifndef __OPENCL_C_VERSION__
}  // namespace impactdic
#endif
#endif  // IMPACTDIC_KERNELS_TYPES_H_
