// The plane of motion as a camera sees it: from picture points to metres and back.
//
// World axes: X along the picture's rows and Y up the picture, both as they lie in the plane at the
// picture's middle; Z out of the plane towards the camera. Origin: the point of the plane that is
// seen at the centre of the bottom-left pixel. Metres.
#pragma once

#include <Eigen/Core>

#include "host/camera/lens.h"

namespace impactdic::camera {

// The turn about a vector by its length, radians.
Eigen::Matrix3d turned_by(const Eigen::Vector3d& vector);

class PlaneView {
 public:
  explicit PlaneView(const Camera& camera);

  // The picture point of a point in world axes, px. `slope`: (2, 3), by the point.
  Eigen::Vector2d to_picture(const Eigen::Vector3d& world,
                             Eigen::Matrix<double, 2, 3>* slope = nullptr) const;

  // X and Y of the point that is seen there, `z` before the plane; NaN where there is none.
  // `slope`: by the picture point, m/px.
  Eigen::Vector2d to_plane(const Eigen::Vector2d& point_px, double z = 0,
                           Eigen::Matrix2d* slope = nullptr) const;

  // Root of the area that a pixel of the picture's middle covers in the plane, m.
  double metre_per_px(double z = 0) const;
  // The centre of projection, in world axes.
  const Eigen::Vector3d& eye() const { return eye_; }
  // Direction of the line of sight at the picture's middle, in world axes.
  Eigen::Vector3d sight() const;
  // Between the line of sight at the picture's middle and the plane's normal.
  double tilt_rad() const;

 private:
  Eigen::Vector2d middle() const;

  Lens lens_;
  int width_, height_;
  Eigen::Matrix3d axes_;    // columns: world axes in camera axes
  Eigen::Vector3d origin_;  // in camera axes
  Eigen::Vector3d eye_;
};

}  // namespace impactdic::camera
