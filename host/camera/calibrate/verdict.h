// What a calibration is worth, and what is missing.
#pragma once

#include <impactdic/camera/calibrate.h>

namespace impactdic::camera {

// Sets scale, tilt, the worst place and the verdict of a result whose camera, pictures and points
// are known.
void judge(const CalibrateRequest& request, CalibrateResult& result);

}  // namespace impactdic::camera
