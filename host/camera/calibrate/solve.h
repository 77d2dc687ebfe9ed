// From points in pictures to a camera with covariance: robust, and with no more terms of
// distortion than the pictures speak for.
#pragma once

#include <impactdic/camera/model.h>

#include "host/camera/calibrate/bundle.h"

namespace impactdic::camera {

struct Solved {
  Camera camera;
  Adjusted state;    // the model that is most probable
  Weights weights;   // points that take part
  double sd_px = 0;  // of a point, along one axis, all views together
};

// `plane`: the view in the plane of motion. Models of the
// distortion are weighed by how probable the points make them (Schwarz 1978); the camera is their
// mean, and what they differ by is part of the covariance (Hoeting et al. 1999). `pitch_sd`:
// relative deviation of the target's pitch, which all lengths share. Throws InvalidArgument where
// no camera can be found.
Solved solve(const Bundle& bundle, int width, int height, std::size_t plane, double pitch_sd,
             const char* from);

}  // namespace impactdic::camera
