#include "host/camera/plane_field.h"

#include <cmath>
#include <utility>

namespace impactdic::camera {

using Eigen::Vector2d;

namespace {

constexpr int kSide = 5;  // points of a region along a side

}  // namespace

PlaneField::PlaneField(const Camera& camera, std::vector<Vector2d> points_px, double metre_per_px)
    : view_(camera), metre_per_px_(metre_per_px), points_px_(std::move(points_px)) {
  places_.reserve(points_px_.size());
  for (const Vector2d& point : points_px_) places_.push_back(view_.to_plane(point));
}

Vector2d PlaneField::displacement(std::size_t point, const Vector2d& shift_px,
                                  Eigen::Matrix2d* slope) const {
  return view_.to_plane(points_px_[point] + shift_px, 0, slope) - places_[point];
}

Vector2d PlaneField::corrected_px(std::size_t point) const {
  return {places_[point].x() / metre_per_px_, -places_[point].y() / metre_per_px_};
}

std::vector<Vector2d> points_of_region(const Vector2d& centre_px, double width_px,
                                       double height_px) {
  std::vector<Vector2d> points;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      const Vector2d off(static_cast<double>(column) / (kSide - 1) - 0.5,
                         static_cast<double>(row) / (kSide - 1) - 0.5);
      points.push_back(centre_px + off.cwiseProduct(Vector2d(width_px, height_px)));
    }
  }
  return points;
}

PlaneTurn plane_turn(const PlaneField& region, const Vector2d& shift_px, double angle,
                     const Vector2d& centre_px) {
  // In the picture y is down: a turn that is counter-clockwise as seen takes x to (c, -s).
  const double c = std::cos(angle), s = std::sin(angle);
  const auto count = static_cast<double>(region.size());
  Vector2d middle = Vector2d::Zero(), middle_after = Vector2d::Zero();
  std::vector<Vector2d> after;
  const std::vector<Vector2d>& points = region.points_px();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector2d off = points[i] - centre_px;
    const Vector2d turned(c * off.x() + s * off.y(), -s * off.x() + c * off.y());
    after.push_back(region.place(i) + region.displacement(i, shift_px + turned - off));
    middle += region.place(i) / count;
    middle_after += after.back() / count;
  }
  double along = 0, across = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector2d a = region.place(i) - middle, b = after[i] - middle_after;
    along += a.dot(b);
    across += a.x() * b.y() - a.y() * b.x();
  }
  PlaneTurn found;
  found.angle = std::atan2(across, along);
  const Vector2d off = region.place(points.size() / 2) - middle;  // the centre is the middle one
  const double cp = std::cos(found.angle), sp = std::sin(found.angle);
  found.shift =
      middle_after - middle +
      Vector2d(cp * off.x() - sp * off.y() - off.x(), sp * off.x() + cp * off.y() - off.y());
  return found;
}

}  // namespace impactdic::camera
