// The plane of a flat target as a camera sees it.
#pragma once

#include "host/camera/calibrate/bundle.h"
#include "host/camera/lens.h"

namespace impactdic::camera {

class BoardSight {
 public:
  // `pose`: of the target, in camera axes.
  BoardSight(const LensValues& lens, const Pose& pose);

  // Where a point of the target, m, is seen, px.
  Eigen::Vector2d to_picture(const Eigen::Vector2d& board_m) const;

  // The point of the target that is seen there, m; NaN where there is none. `slope`: by the
  // picture point, m/px.
  Eigen::Vector2d to_board(const Eigen::Vector2d& point_px, Eigen::Matrix2d* slope = nullptr) const;

  // Between the line of sight to the target's origin and its normal.
  double tilt_rad() const;

 private:
  Lens lens_;
  Eigen::Matrix3d to_sight_, to_target_;  // homographies between board and lines of sight
};

}  // namespace impactdic::camera
