// A calibrated camera: lens, distortion, and the plane in which the ball moves.
//
// Image axes: x right, y down, pixel centres at integers. Camera axes: x right, y down, z away from
// the camera, origin at the centre of projection; metres.
#pragma once

#include <impactdic/export.h>
#include <impactdic/measured.h>

#include <array>
#include <cstddef>
#include <string>

namespace IMPACTDIC_PUBLIC impactdic {

// What a camera is made of. A point (x, y, z) in camera axes has the picture point
// (fx x_d + cx, fy y_d + cy) with a = x/z, b = y/z, s = a^2 + b^2 and
//   x_d = a (1 + k1 s + k2 s^2 + k3 s^3) + 2 p1 a b + p2 (s + 2 a^2)
//   y_d = b (1 + k1 s + k2 s^2 + k3 s^3) + p1 (s + 2 b^2) + 2 p2 a b
// (Brown 1971, as OpenCV writes it). The plane of motion holds the points R (u, v, 0) + t: R is the
// turn by the vector `rotation` (its length the angle, rad), t is `position`, m.
enum class CameraParameter {
  kFx,  // focal length in px along x, and y
  kFy,
  kCx,  // principal point, px
  kCy,
  kK1,  // radial distortion
  kK2,
  kP1,  // decentring
  kP2,
  kK3,
  kRotationX,
  kRotationY,
  kRotationZ,
  kPositionX,
  kPositionY,
  kPositionZ,
};
inline constexpr std::size_t kCameraParameters = 15;
const char* to_string(CameraParameter parameter);  // its key in camera.toml, with its unit

struct Camera {
  int width = 0, height = 0;  // of the pictures it was calibrated with, px
  // Indexed by CameraParameter.
  std::array<double, kCameraParameters> values{};
  // Of the values: variances and covariances, (kCameraParameters, kCameraParameters), row-major.
  std::array<double, kCameraParameters * kCameraParameters> covariance{};
  // False where the pictures do not tell the focal length: then only points of the plane of motion
  // are known in metres, none before or behind it.
  bool focal_length_known = false;
  std::string from;  // what it was calibrated with: "checkerboard", "charuco", "dots", "ruler"

  double operator[](CameraParameter p) const { return values[static_cast<std::size_t>(p)]; }
  double& operator[](CameraParameter p) { return values[static_cast<std::size_t>(p)]; }
  double variance(CameraParameter p) const {
    return covariance[static_cast<std::size_t>(p) * (kCameraParameters + 1)];
  }

  // Throws InvalidArgument: no size, a number that is not finite, a focal length that is not
  // positive, a plane that the camera does not look at, a distortion that folds the picture, a
  // covariance that is not symmetric or has negative variances.
  void validate() const;
};

// What a camera says of the plane of motion.
struct PlaneFigures {
  std::string from;                // what the camera was calibrated with (Camera::from)
  Measured metre_per_px;           // at the picture's middle
  double tilt_deg = kNotMeasured;  // of the line of sight there; NaN: focal length not known
  double distortion_px = 0;        // what the lens moves a point of the picture by, at most
};
PlaneFigures figures_of(const Camera& camera);

// camera.toml (docs/camera.md). Throws FileError where the file cannot be read; FormatError where
// it is no TOML, a key is missing, unknown or of another kind, or the camera is impossible.
Camera read_camera(const std::string& path);
// Writes to a temporary file and renames it. Throws InvalidArgument, FileError.
void write_camera(const Camera& camera, const std::string& path);

}  // namespace impactdic
