// From points in pictures to a camera with covariance: robust, and with no more terms of
// distortion than the pictures speak for.
#pragma once

#include <impactdic/camera/model.h>

#include "host/camera/calibrate/bundle.h"

namespace impactdic::camera {

struct Solved {
  Camera camera;
  Adjusted state;    // the model with the least AICc
  Weights weights;   // points that take part
  double sd_px = 0;  // of a point, along one axis, all views together
};

// `plane`: the view in the plane of motion. The model is that with the least corrected Akaike
// criterion (Hurvich and Tsai 1989); where others are about as good, their difference is part of
// the covariance (Burnham and Anderson 2002, Eq. 6.12). `pitch_sd`: relative deviation of the
// target's pitch, which all lengths share. Throws InvalidArgument where no camera can be found.
Solved solve(const Bundle& bundle, int width, int height, std::size_t plane, double pitch_sd,
             const char* from);

}  // namespace impactdic::camera
