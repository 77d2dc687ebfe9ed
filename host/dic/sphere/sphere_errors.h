// What a sphere's registration makes of a centre, a radius and a distance that are not quite right.
#pragma once

#include <array>

#include "host/dic/rigid_fit.h"
#include "kernels/types.h"

namespace impactdic::dic {

// Deviations of what the registration was told: px of the first picture, and the radius over the
// camera's distance.
struct SphereSource {
  double radius_px = 0;
  double radius_sd_px = 0;
  double cx_sd_px = 0, cy_sd_px = 0;
  double nearness_sd = 0;
  // The centre in both pictures from the optical axis, image axes.
  std::array<double, 2> aside_px{}, later_aside_px{};
  BallLight light{};  // on the sphere
};

// Widens the deviations of `motion`, and corrects their correlations, by what errors of the centre,
// of the radius and of the distance do to it (source_response).
void add_source_errors(RigidMotion& motion, const SphereSource& source);

}  // namespace impactdic::dic
