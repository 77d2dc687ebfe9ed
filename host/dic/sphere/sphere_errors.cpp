#include "host/dic/sphere/sphere_errors.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "host/dic/sphere/rotation.h"

namespace impactdic::dic {
namespace {

using Motion = Eigen::Matrix<double, 5, 1>;       // X, Y and the turns about X, Y, Z
using Response = Eigen::Matrix<double, 5, 3>;     // of it to the centre's X, Y and the radius
using Shift = Eigen::Matrix<double, 2, 5>;        // of a pixel of the first picture by a motion
using SourceShift = Eigen::Matrix<double, 2, 3>;  // by an error
constexpr int kAcross = 13;                       // points over the disc
constexpr double kLeastDepth = 0.1, kFullDepth = 0.4;  // of the radius, as the kernel weighs pixels

// Unit sphere, camera axes.
Response response_to(const Eigen::Quaterniond& turn, double radius_px) {
  const Eigen::Matrix3d q = turn.toRotationMatrix();
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
  Response response = normal.ldlt().solve(right);
  response.bottomRows<3>() /= radius_px;  // rad a px
  return response;
}

Eigen::Quaterniond turn_of(const RigidMotion& motion) {
  return quaternion_of({motion.rot_x_rad, motion.rot_y_rad, motion.rot_rad});
}

}  // namespace

Eigen::Matrix<double, 5, 1> response_to_radius(const RigidMotion& motion, double radius_px) {
  Eigen::Matrix<double, 5, 1> response = response_to(turn_of(motion), radius_px).col(2);
  response[1] = -response[1];  // y down
  return response;
}

void add_source_errors(RigidMotion& motion, const SphereSource& source) {
  const Response response = response_to(turn_of(motion), source.radius_px);
  if (!response.allFinite()) return;
  const Eigen::Vector3d sd(source.cx_sd_px, source.cy_sd_px, source.radius_sd_px);
  const Response spread = response * sd.asDiagonal();
  const Eigen::Matrix<double, 5, 5> more = spread * spread.transpose();
  const auto widen = [&](double& shift_sd, double& turn_sd, double& correlation, int shift_row,
                         int turn_row, double sign) {
    const double shared = correlation * shift_sd * turn_sd + sign * more(shift_row, turn_row);
    shift_sd = std::hypot(shift_sd, std::sqrt(more(shift_row, shift_row)));
    turn_sd = std::hypot(turn_sd, std::sqrt(more(turn_row, turn_row)));
    correlation = shared / (shift_sd * turn_sd);
  };
  widen(motion.dx_sd_px, motion.rot_y_sd_rad, motion.dx_rot_y_corr, 0, 3, 1);
  widen(motion.dy_sd_px, motion.rot_x_sd_rad, motion.dy_rot_x_corr, 1, 2, -1);  // y down
  motion.rot_sd_rad = std::hypot(motion.rot_sd_rad, std::sqrt(more(4, 4)));
}

}  // namespace impactdic::dic
