// What a calibration is worth, and what is missing.
#pragma once

#include <impactdic/camera/calibrate.h>

namespace impactdic::camera {

// Sets scale, tilt, the worst place and the verdict of a result whose camera, pictures and points
// are known.
void judge(const CalibrateRequest& request, CalibrateResult& result);

// Share of the deviations of places and scale that the camera's covariance makes.
Measured scale_at_middle(const Camera& camera);

}  // namespace impactdic::camera
