// What a sphere's registration makes of a centre and a radius that are not quite right.
#pragma once

#include <Eigen/Core>

#include "host/dic/rigid_fit.h"

namespace impactdic::dic {

// Deviations of what the registration was told of the first picture, px.
struct SphereSource {
  double radius_px = 0;
  double radius_sd_px = 0;
  double cx_sd_px = 0, cy_sd_px = 0;
};

// Widens the deviations of `motion`, and corrects their correlations, by what errors of the centre
// and of the radius do to it: least squares over the visible part of the sphere, of texture alike
// everywhere, linear in the errors and exact in the turn.
void add_source_errors(RigidMotion& motion, const SphereSource& source);

// By how much more a motion is measured for each px by which the radius is told too large: dx, dy
// (px, image axes) and the turns about X, Y and Z (rad). Of the same model.
Eigen::Matrix<double, 5, 1> response_to_radius(const RigidMotion& motion, double radius_px);

}  // namespace impactdic::dic
