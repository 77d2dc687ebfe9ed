// The lens: from directions to points of the picture and back.
#pragma once

#include <impactdic/camera/model.h>

#include <Eigen/Core>

namespace impactdic::camera {

class Lens {
 public:
  explicit Lens(const Camera& camera);

  // Direction (x/z, y/z) of a point to its picture point, px; CameraParameter has the formula.
  // `slope`: of the picture point by the direction.
  Eigen::Vector2d project(const Eigen::Vector2d& direction, Eigen::Matrix2d* slope = nullptr) const;

  // The direction that has this picture point, by Newton's method; NaN where there is none.
  // `slope`: of the direction by the picture point.
  Eigen::Vector2d direction(const Eigen::Vector2d& point_px,
                            Eigen::Matrix2d* slope = nullptr) const;

  // Where a camera without distortion, but with the same focal lengths and principal point, would
  // see the point; px.
  Eigen::Vector2d undistort(const Eigen::Vector2d& point_px) const;

 private:
  Eigen::Vector2d focal_, principal_;
  double k1_, k2_, k3_, p1_, p2_;
};

}  // namespace impactdic::camera
