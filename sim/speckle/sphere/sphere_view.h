// A sphere before the camera at one instant, cut into the lines of the picture. Internal to the
// renderer.
//
// A horizontal line of the picture is a plane through the eye; it cuts the sphere in a circle
//   P(a) = m + rho (e1 sin a + e2 cos a),   e2 towards the eye, e1 to the right,
// of which |a| <= visible is seen. A half-space w · P >= b, which is what a cap of ink is, cuts
// that circle in an arc. A ball that is squashed in the picture's plane is round again in a space
// that is stretched alike: planes stay planes there, and the same holds.
#pragma once

#include <Eigen/Core>
#include <array>

#include "sim/speckle/render_parts.h"
#include "sim/speckle/sphere/sphere.h"

namespace impactdic::sim::speckle {

// Up to two stretches of a line, ascending.
struct Stretches {
  std::array<Span, 2> span{Span{1, 0}, Span{1, 0}};
  int count = 0;
  bool whole = false;  // one arc, both of whose ends are seen
  void add(double first, double last) {
    if (first < last) span[static_cast<std::size_t>(count++)] = {first, last};
  }
};
Stretches meet(const Stretches& a, const Stretches& b);

// One line of the picture.
class SphereLine {
 public:
  bool empty() const { return !(rho_ > 0); }
  // The sphere's outline on this line, px.
  Span outline() const { return outline_; }
  // Where w · P >= b is seen; `w` in camera axes.
  Stretches stretches(const Eigen::Vector3d& w, double b) const;
  // Draws the line's picture wider about the middle of the outline.
  void widen(double factor);
  // The point of the round ball, about its centre, that is seen at column x within the outline.
  Eigen::Vector3d point(double x) const;

 private:
  friend class SphereView;
  double column(double sine, double cosine) const {
    return (n0_ + n1_ * sine + n2_ * cosine) / (d0_ + d1_ * sine + d2_ * cosine);
  }

  Eigen::Vector3d m_, e1_, e2_;
  double rho_ = 0, visible_ = 0;  // cosine of the last visible angle
  double n0_ = 0, n1_ = 0, n2_ = 0, d0_ = 1, d1_ = 0, d2_ = 0;
  Span outline_{1, 0};
};

class SphereView {
 public:
  // Throws InvalidArgument for an impossible compression, or a sphere that comes too near.
  SphereView(const BallPose& pose, double radius_px, const SynthScene& scene);

  SphereLine line(double y) const;
  // The sphere's stretch of columns and of rows.
  Span columns() const { return columns_; }
  Span rows() const { return rows_; }
  // Rows that a cap (unit vector in camera axes, radius in px) may be seen on; empty if on none.
  Span rows_of(const Eigen::Vector3d& centre, double radius_px) const;
  // Direction from a point of the round ball to the camera; unit vector.
  Eigen::Vector3d to_camera(const Eigen::Vector3d& point) const;
  const Eigen::Matrix3d& turn() const { return turn_; }  // ball axes to camera axes

 private:
  Eigen::Vector3d squash(const Eigen::Vector3d& p) const { return p - c_ * axis_.dot(p) * axis_; }
  Eigen::Vector3d stretch(const Eigen::Vector3d& p) const {
    return p + c_ / (1 - c_) * axis_.dot(p) * axis_;
  }

  double radius_, x0_, y0_, distance_, c_;
  bool parallel_;
  Eigen::Vector3d axis_;    // of the compression
  Eigen::Vector3d centre_;  // of the ball in camera axes about the eye; of parallel rays about 0
  Eigen::Vector3d eye_;     // about the centre of the round ball; of parallel rays a direction
  Eigen::Matrix3d turn_;
  Span columns_, rows_;
};

}  // namespace impactdic::sim::speckle
