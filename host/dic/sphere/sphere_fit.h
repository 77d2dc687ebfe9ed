// The motion of a sphere that a displacement field on it carries, found robustly: where the
// registration of the whole sphere starts from.
#pragma once

#include <Eigen/Geometry>
#include <span>

#include "host/dic/rigid_fit.h"

namespace impactdic::dic {

// Centre and radius in the first picture, px, and how far the centre is thought to move.
struct SphereGuess {
  double cx_px = 0, cy_px = 0, radius_px = 0;
  double dx_px = 0, dy_px = 0;
  double shift_sd_px = 0.3;  // of dx_px and dy_px
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
};

struct SphereFit {
  bool ok = false;
  double dx_px = 0, dy_px = 0;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  double share = 0;        // of the points on the sphere that agree on it
  int used = 0;            // as many
  double residual_px = 0;  // robust scatter of the points
  // Of the turns about X and Y, were the points' errors independent.
  double rot_x_sd_rad = 0, rot_y_sd_rad = 0;
};

// Where parallel rays show the point of the sphere that is seen at (x, y) px once it has moved;
// false where it is turned out of sight, or (x, y) is beside the sphere.
bool carry(const SphereGuess& motion, double x_px, double y_px, double& to_x_px, double& to_y_px);

// Gauss and Newton on two translations and SO(3) with Tukey's weights, from `guess`, whose shift
// counts as one more measurement: a field alone tells a shift from a turn about the axis across it
// by the field's curvature only. Fewer than eight points: not ok.
SphereFit fit_sphere_motion(std::span<const PointMotion> points, const SphereGuess& guess);

}  // namespace impactdic::dic
