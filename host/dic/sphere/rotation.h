// Turns in space, as rotation vectors and unit quaternions in the camera's axes: X right, Y up, Z
// towards the camera, so that a turn about Z is counter-clockwise on the screen.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

namespace impactdic::dic {

// Radians about the vector's direction.
inline Eigen::Quaterniond quaternion_of(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle < 1e-12) return Eigen::Quaterniond(1, vector.x() / 2, vector.y() / 2, vector.z() / 2);
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector / angle));
}

// At most pi long.
inline Eigen::Vector3d rotation_vector(Eigen::Quaterniond q) {
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double length = q.vec().norm();
  if (length < 1e-12) return 2 * q.vec();
  return 2 * std::atan2(length, q.w()) / length * q.vec();
}

// The same turn as a matrix in the picture's axes with the depth: x right, y down, z as Z.
inline Eigen::Matrix3d in_picture(const Eigen::Quaterniond& turn) {
  const Eigen::Vector3d down(1, -1, 1);
  return down.asDiagonal() * turn.toRotationMatrix() * down.asDiagonal();
}

}  // namespace impactdic::dic
