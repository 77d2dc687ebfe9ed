// A camera with every kind of distortion, looking askew at its plane.
#pragma once

#include <impactdic/camera/model.h>

namespace impactdic::testing {

inline Camera askew_camera() {
  using P = CameraParameter;
  Camera camera;
  camera.width = 640;
  camera.height = 400;
  camera.from = "checkerboard";
  camera.focal_length_known = true;
  camera[P::kFx] = 1500;
  camera[P::kFy] = 1498;
  camera[P::kCx] = 322.4;
  camera[P::kCy] = 196.1;
  camera[P::kK1] = -0.21;
  camera[P::kK2] = 0.13;
  camera[P::kP1] = 0.0011;
  camera[P::kP2] = -0.0007;
  camera[P::kK3] = 0.02;
  camera[P::kRotationX] = 3.05;  // the target's z points into it
  camera[P::kRotationY] = 0.21;
  camera[P::kRotationZ] = -0.14;
  camera[P::kPositionX] = -0.09;
  camera[P::kPositionY] = 0.06;
  camera[P::kPositionZ] = 0.81;
  for (std::size_t i = 0; i < kCameraParameters; ++i) {
    for (std::size_t k = 0; k < kCameraParameters; ++k) {
      const double sd_i = 1e-3 / static_cast<double>(i + 1),
                   sd_k = 1e-3 / static_cast<double>(k + 1);
      camera.covariance[i * kCameraParameters + k] = sd_i * sd_k * (i == k ? 1.0 : 0.25);
    }
  }
  return camera;
}

}  // namespace impactdic::testing
