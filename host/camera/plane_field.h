// A displacement field as it lies in the plane of motion.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/camera/plane_view.h"

namespace impactdic::camera {

// Points of the picture that stand still in every reference, and where they go.
class PlaneField {
 public:
  // `points_px`: the points; `metre_per_px`: of corrected pixels (below), whatever the camera.
  PlaneField(const Camera& camera, std::vector<Eigen::Vector2d> points_px, double metre_per_px);

  std::size_t size() const { return points_px_.size(); }
  const std::vector<Eigen::Vector2d>& points_px() const { return points_px_; }
  // The point in world axes, m.
  const Eigen::Vector2d& place(std::size_t point) const { return places_[point]; }
  // Where the point goes, m in world axes, by its displacement in the picture, px; NaN where the
  // camera has no such point. `slope`: by the displacement, m/px.
  Eigen::Vector2d displacement(std::size_t point, const Eigen::Vector2d& shift_px,
                               Eigen::Matrix2d* slope = nullptr) const;
  // The point as a camera without distortion would see it that looks squarely at the plane:
  // `metre_per_px` a pixel, y down.
  Eigen::Vector2d corrected_px(std::size_t point) const;

 private:
  PlaneView view_;
  double metre_per_px_;
  std::vector<Eigen::Vector2d> points_px_, places_;
};

// The rigid motion that the picture shows, of a region about `centre_px`, in the plane of motion.
struct PlaneTurn {
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  // of the point seen at the centre, m
  double angle = 0;                                 // counter-clockwise, rad
};

// Points of a rectangle about its centre, from which a motion of all of it follows: 5 by 5.
std::vector<Eigen::Vector2d> points_of_region(const Eigen::Vector2d& centre_px, double width_px,
                                              double height_px);

// `region`: points_of_region of the region. Least squares over its points (Arun, Huang and
// Blostein 1987).
PlaneTurn plane_turn(const PlaneField& region, const Eigen::Vector2d& shift_px, double angle,
                     const Eigen::Vector2d& centre_px);

}  // namespace impactdic::camera
