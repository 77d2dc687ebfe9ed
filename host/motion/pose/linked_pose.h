// A pose with what a chain of registrations knows of its errors.
#pragma once

#include <array>

#include "host/clip/track_row.h"
#include "host/motion/perspective.h"

namespace impactdic::motion {

// A sphere's radius: as registrations are told it, and the deviation that the steps from frame to
// frame hold of it; by how much it is thought to be too large, and the deviation of that. From
// where the sphere is seen, as registrations are told; by how much the radius over the distance is
// thought to be too large, the deviation of that as a share of what was told, and how both errors
// go together.
struct SphereRadius {
  double px = 0, told_sd_px = 0;
  double error_px = 0, sd_px = told_sd_px;
  Perspective perspective;
  double nearness_error = 0, nearness_share = 1, correlation = 0;
  BallLight light{};  // on the sphere; all 0: not known

  double nearness_sd() const { return nearness_share * perspective.nearness_sd; }
};

// A pose at the end of a chain of registrations. Its deviations are those of their noise, which is
// another in every link; the errors of the radius and of the distance are the same in all of them,
// and what they do adds up. A sphere carries errors of its turn along: those about one axis become
// errors about another.
struct LinkedPose : BodyPose {
  // Of a sphere: covariance of the turn's noise about X, Y and Z, rad², row by row.
  std::array<double, 9> turn_noise_rad2{};
  // What each px by which the radius is larger than thought did to place and turn: px, x right and
  // y down, and rad about X, Y and Z.
  double radius_x = 0, radius_y = 0;
  std::array<double, 3> radius_turn_rad{};

  // The same for each unit of the radius over the distance.
  double nearness_x = 0, nearness_y = 0;
  std::array<double, 3> nearness_turn_rad{};

  // The pose with all that is known to be uncertain, radius and distance by their deviations.
  BodyPose stated(const SphereRadius& radius) const;
};

}  // namespace impactdic::motion
