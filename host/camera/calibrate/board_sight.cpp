#include "host/camera/calibrate/board_sight.h"

#include <Eigen/Geometry>  // homogeneous, hnormalized
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/camera/plane_view.h"

namespace impactdic::camera {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Camera camera_with(const LensValues& lens) {
  Camera camera;
  for (std::size_t i = 0; i < kLensValues; ++i) {
    camera.values[i] = lens[static_cast<Eigen::Index>(i)];
  }
  return camera;
}

}  // namespace

BoardSight::BoardSight(const LensValues& lens, const Pose& pose) : lens_(camera_with(lens)) {
  to_sight_ << turned_by(pose.head<3>()).leftCols<2>(), pose.tail<3>();
  to_target_ = to_sight_.inverse();
}

Vector2d BoardSight::to_picture(const Vector2d& board_m) const {
  return lens_.project((to_sight_ * board_m.homogeneous()).hnormalized());
}

Vector2d BoardSight::to_board(const Vector2d& point_px, Eigen::Matrix2d* slope) const {
  const Vector2d direction = lens_.direction(point_px, slope);
  const Vector3d at = to_target_ * direction.homogeneous();
  const Vector2d board = at.hnormalized();
  if (slope != nullptr) {
    const Eigen::Matrix2d by_direction =
        (to_target_.topLeftCorner<2, 2>() - board * to_target_.bottomLeftCorner<1, 2>()) / at.z();
    *slope = by_direction * *slope;
  }
  return board;
}

double BoardSight::tilt_rad() const {
  const Vector3d normal = to_sight_.col(0).cross(to_sight_.col(1));
  return std::acos(std::min(1.0, std::abs(normal.dot(to_sight_.col(2).normalized()))));
}

}  // namespace impactdic::camera
