// What a sphere's registration makes of a centre and a radius that are not quite right.
#pragma once

#include "host/dic/rigid_fit.h"

namespace impactdic::dic {

// Deviations of what the registration was told of the first picture, px.
struct SphereSource {
  double radius_px = 0;
  double radius_sd_px = 0;
  double cx_sd_px = 0, cy_sd_px = 0;
};

// Widens the deviations of `motion`, and corrects their correlations, by what errors of the centre
// and of the radius do to it (source_response).
void add_source_errors(RigidMotion& motion, const SphereSource& source);

}  // namespace impactdic::dic
