#include "host/camera/plane_view.h"

#include <Eigen/Geometry>
#include <cmath>

namespace impactdic::camera {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Matrix3d turned_by(const Vector3d& vector) {
  const double angle = vector.norm();
  if (angle == 0) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

PlaneView::PlaneView(const Camera& camera)
    : lens_(camera), width_(camera.width), height_(camera.height) {
  using P = CameraParameter;
  const Matrix3d turn =
      turned_by({camera[P::kRotationX], camera[P::kRotationY], camera[P::kRotationZ]});
  const Vector3d position(camera[P::kPositionX], camera[P::kPositionY], camera[P::kPositionZ]);
  Vector3d normal = turn.col(2);
  if (normal.dot(position) > 0) normal = -normal;  // towards the camera
  // Where the lines of sight through a point, and beside it, meet the plane.
  const double distance = normal.dot(position);
  const auto seen = [&](const Vector2d& direction) -> Vector3d {
    const Vector3d ray(direction.x(), direction.y(), 1);
    return ray * (distance / normal.dot(ray));
  };
  Matrix2d slope;
  const Vector2d ahead = lens_.direction(middle(), &slope);
  const Vector3d ray(ahead.x(), ahead.y(), 1), along(slope(0, 0), slope(1, 0), 0);
  const double depth = distance / normal.dot(ray);
  // d(ray depth) for a step along the row: the part in the plane.
  const Vector3d right = (along - ray * (normal.dot(along) / normal.dot(ray))) * depth;
  axes_.col(0) = right.normalized();
  axes_.col(2) = normal;
  axes_.col(1) = normal.cross(axes_.col(0));
  origin_ = seen(lens_.direction({0.0, height_ - 1.0}));
  eye_ = -(axes_.transpose() * origin_);
}

Vector2d PlaneView::middle() const { return {(width_ - 1) / 2.0, (height_ - 1) / 2.0}; }

Vector2d PlaneView::to_picture(const Vector3d& world, Eigen::Matrix<double, 2, 3>* slope) const {
  const Vector3d point = axes_ * world + origin_;
  const Vector2d direction = point.head<2>() / point.z();
  if (slope == nullptr) return lens_.project(direction);
  Matrix2d by_direction;
  const Vector2d seen = lens_.project(direction, &by_direction);
  Eigen::Matrix<double, 2, 3> by_point;
  by_point << 1, 0, -direction.x(), 0, 1, -direction.y();
  *slope = by_direction * (by_point / point.z()) * axes_;
  return seen;
}

Vector2d PlaneView::to_plane(const Vector2d& point_px, double z, Matrix2d* slope) const {
  Matrix2d by_pixel;
  const Vector2d direction = lens_.direction(point_px, &by_pixel);
  const Vector3d ray = axes_.transpose() * Vector3d(direction.x(), direction.y(), 1);
  const double depth = (z - eye_.z()) / ray.z();
  if (slope != nullptr) {
    const Eigen::Matrix<double, 3, 2> by_direction = axes_.transpose().leftCols<2>();
    const Eigen::Matrix<double, 2, 2> ahead = by_direction.topRows<2>() * depth;
    const Eigen::RowVector2d nearer = by_direction.row(2) * (-depth / ray.z());
    *slope = (ahead + ray.head<2>() * nearer) * by_pixel;
  }
  return eye_.head<2>() + ray.head<2>() * depth;
}

double PlaneView::metre_per_px(double z) const {
  Matrix2d slope;
  to_plane(middle(), z, &slope);
  return std::sqrt(std::abs(slope(0, 0) * slope(1, 1) - slope(0, 1) * slope(1, 0)));
}

Vector3d PlaneView::sight() const {
  const Vector2d ahead = lens_.direction(middle());
  return axes_.transpose() * Vector3d(ahead.x(), ahead.y(), 1).normalized();
}

double PlaneView::tilt_rad() const {
  const Vector3d ray = sight();
  return std::atan2(ray.head<2>().norm(), std::abs(ray.z()));
}

}  // namespace impactdic::camera
