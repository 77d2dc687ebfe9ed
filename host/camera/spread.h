// What a camera's covariance does to something worked out with it (JCGM 102:2011, section 6.2: the
// law of propagation, with differences in place of derivatives).
#pragma once

#include <impactdic/camera/model.h>
#include <impactdic/measured.h>

#include <functional>
#include <vector>

namespace impactdic::camera {

// A step along one principal axis of the covariance, and its size in deviations. Steps are small,
// so that what follows from them is straight.
struct CameraStep {
  Camera plus, minus;
  double deviations = 0;
};

// One for every axis that is uncertain; none of a camera that is exact.
std::vector<CameraStep> principal_steps(const Camera& camera);

// Standard deviations of what `figures` says, by the camera alone.
std::vector<double> spread(const Camera& camera,
                           const std::function<std::vector<double>(const Camera&)>& figures);

// What the lens moves a corner of the picture by, at most, px.
double largest_distortion_px(const Camera& camera);

// Metres a pixel in the plane of motion, at the picture's middle.
Measured scale_at_middle(const Camera& camera);

}  // namespace impactdic::camera
