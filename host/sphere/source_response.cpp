#include "host/sphere/source_response.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace impactdic::sphere {
namespace {

using Response = Eigen::Matrix<double, 5, 3>;     // X, Y, turns about X, Y, Z; to X, Y, radius
using Shift = Eigen::Matrix<double, 2, 5>;        // of a pixel of the first picture by a motion
using SourceShift = Eigen::Matrix<double, 2, 3>;  // by an error
constexpr int kAcross = 13;                       // points over the disc
constexpr double kLeastDepth = 0.2, kFullDepth = 0.5;  // of the radius, as the kernel weighs pixels

// Unit sphere, camera axes.
Response response_of(const Eigen::Matrix3d& q) {
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Response right = Response::Zero();
  for (int j = 0; j < kAcross; ++j) {
    for (int i = 0; i < kAcross; ++i) {
      const double x = 2 * (i + 0.5) / kAcross - 1, y = 2 * (j + 0.5) / kAcross - 1;
      if (x * x + y * y >= 1) continue;
      const Eigen::Vector3d at(x, y, std::sqrt(1 - x * x - y * y));
      const double depth = std::min(at.z(), (q * at).z());
      const double weight =
          std::clamp((depth - kLeastDepth) / (kFullDepth - kLeastDepth), 0.0, 1.0);
      if (weight == 0) continue;
      Eigen::Matrix<double, 3, 2> lift;  // along the sphere where the first picture's pixel moves
      lift << 1, 0, 0, 1, -x / at.z(), -y / at.z();
      const Eigen::Matrix2d local = (q * lift).topRows<2>();
      const Eigen::Matrix2d back = local.inverse();
      Shift by_motion;
      by_motion.leftCols<2>() = back;
      for (int axis = 0; axis < 3; ++axis) {
        by_motion.col(2 + axis) = back * (q * Eigen::Vector3d::Unit(axis).cross(at)).head<2>();
      }
      SourceShift by_error;
      by_error.leftCols<2>() = back - Eigen::Matrix2d::Identity();
      by_error.col(2) = back * q.col(2).head<2>() / at.z();
      normal += weight * by_motion.transpose() * by_motion;
      right -= weight * by_motion.transpose() * by_error;
    }
  }
  return normal.ldlt().solve(right);
}

}  // namespace

SourceResponse source_response(const std::array<double, 3>& turn, double radius_px) {
  const Eigen::Vector3d vector(turn[0], turn[1], turn[2]);
  const double angle = vector.norm();
  Eigen::Matrix3d q = Eigen::Matrix3d::Identity();
  if (angle > 0) q = Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
  const Response up = response_of(q);  // y up
  SourceResponse response;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const double y_down = k == 1 ? -1 : 1;
    response.dx[k] = y_down * up(0, column);
    response.dy[k] = -y_down * up(1, column);
    response.rot_x[k] = y_down * up(2, column) / radius_px;
    response.rot_y[k] = y_down * up(3, column) / radius_px;
    response.rot_z[k] = y_down * up(4, column) / radius_px;
  }
  return response;
}

}  // namespace impactdic::sphere
