// Where a point of a sphere is seen, and which point is seen at a place, from near by and
// compressed: in double precision, by kernels/ball/sight.h's geometry.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace impactdic::dic {

// One picture of the ball: x right, y down, z towards the camera, from the ball's centre.
struct SphereSight {
  double by_distance;
  Eigen::Vector2d aside;  // of the centre from the optical axis, over the distance
  Eigen::Matrix2d stretch = Eigen::Matrix2d::Identity();

  // The point of the round ball that is seen at `p`: where the line from there to the eye meets the
  // compressed ball on the near side.
  Eigen::Vector3d on_ball(const Eigen::Vector2d& p, double radius) const {
    const Eigen::Matrix2d back = stretch.inverse();
    const Eigen::Vector2d through = back * p, along = -leans(p);
    const double a = along.squaredNorm() + 1, b = through.dot(along);
    const double c = through.squaredNorm() - radius * radius;
    const double z = (-b + std::sqrt(std::max(0.0, b * b - a * c))) / a;
    const Eigen::Vector2d at = through + z * along;
    return {at.x(), at.y(), z};
  }
  // By how much the line of sight through `p` leans, along the round ball's axes.
  Eigen::Vector2d leans(const Eigen::Vector2d& p) const {
    return stretch.inverse() * (aside + by_distance * p);
  }
  Eigen::Vector2d picture(const Eigen::Vector3d& q) const {
    return (stretch * q.head<2>() + aside * q.z()) / (1 - by_distance * q.z());
  }
  double facing(const Eigen::Vector3d& q, double radius) const {
    const double along = q.z() - aside.dot(q.head<2>()) - by_distance * radius * radius;
    return along / (radius * (1 - by_distance * q.z()));
  }
};

}  // namespace impactdic::dic
