#include "host/camera/ball_view.h"

#include <impactdic/units.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace impactdic::camera {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr int kOutline = 32;            // points of an outline: harmonics up to the 15th are exact
constexpr int kRings = 3, kSpokes = 8;  // points of a disc, of equal area each
constexpr int kMostSteps = 30;
constexpr double kConverged_px = 1e-10, kConverged_rad = 1e-13;

Matrix2d turned(double angle) {
  Matrix2d turn;
  turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return turn;
}

// The circle of least squares in the distance (Gauss–Newton from the mean).
CircleInPicture fit_circle(const std::array<Vector2d, kOutline>& points) {
  CircleInPicture circle;
  for (const Vector2d& point : points) circle.centre += point / kOutline;
  for (int step = 0; step < kMostSteps; ++step) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Vector3d side = Vector3d::Zero();
    circle.radius = 0;
    for (const Vector2d& point : points) circle.radius += (point - circle.centre).norm() / kOutline;
    for (const Vector2d& point : points) {
      const Vector2d off = point - circle.centre;
      const double distance = off.norm();
      const Vector3d slope(off.x() / distance, off.y() / distance, 1);
      normal += slope * slope.transpose();
      side += slope * (distance - circle.radius);
    }
    const Vector3d change = normal.inverse() * side;
    circle.centre += change.head<2>();
    circle.radius += change.z();
    if (!(change.norm() > kConverged_px)) break;
  }
  return circle;
}

const std::array<Vector2d, kRings * kSpokes>& disc_points() {
  static const auto points = [] {
    std::array<Vector2d, kRings * kSpokes> made;
    std::size_t i = 0;
    for (int ring = 0; ring < kRings; ++ring) {
      const double radius = std::sqrt((ring + 0.5) / kRings);
      for (int spoke = 0; spoke < kSpokes; ++spoke) {
        const double angle = 2 * kPi * (spoke + 0.5 * ring) / kSpokes;
        made[i++] = radius * Vector2d(std::cos(angle), std::sin(angle));
      }
    }
    return made;
  }();
  return points;
}

}  // namespace

CircleInPicture BallView::circle(const BallInPlane& ball) const {
  Vector3d centre(ball.centre.x(), ball.centre.y(), 0);
  Vector3d across = Vector3d::UnitX(), along = Vector3d::UnitY();
  double radius = ball.radius;
  if (sphere_) {
    // Where lines of sight touch the sphere: a circle nearer to the eye.
    const Vector3d sight = plane_.eye() - centre;
    const double share = ball.radius / sight.norm();
    across = Vector3d::UnitY().cross(sight).normalized();
    along = sight.normalized().cross(across);
    centre += sight * (share * share);
    radius *= std::sqrt(1 - share * share);
  }
  std::array<Vector2d, kOutline> points;
  for (int i = 0; i < kOutline; ++i) {
    const double angle = 2 * kPi * i / kOutline;
    points[static_cast<std::size_t>(i)] =
        plane_.to_picture(centre + radius * (std::cos(angle) * across + std::sin(angle) * along));
  }
  return fit_circle(points);
}

BallInPlane BallView::ball(const CircleInPicture& circle_px) const {
  Matrix2d slope;
  BallInPlane found{plane_.to_plane(circle_px.centre, 0, &slope), 0};
  found.radius = circle_px.radius * std::sqrt(std::abs(slope.determinant()));
  for (int step = 0; step < kMostSteps; ++step) {
    const CircleInPicture shown = circle(found);
    const Vector2d off = circle_px.centre - shown.centre;
    const double ratio = circle_px.radius / shown.radius;
    found.centre += slope * off;
    found.radius *= ratio;
    const double change = off.norm() + std::abs(ratio - 1) * circle_px.radius;
    if (!std::isfinite(change)) break;
    if (change < kConverged_px) return found;
  }
  return {Vector2d::Constant(kNotMeasured), kNotMeasured};
}

TurnInPlane BallView::motion_in_picture(const BallInPlane& ball, const CircleInPicture& circle,
                                        const TurnInPlane& motion) const {
  const Matrix2d turn = turned(motion.angle);
  const double reach = ball.radius * std::max(1 - rim_margin_px_ / circle.radius, 0.0);
  const auto& disc = disc_points();
  std::array<Vector2d, kRings * kSpokes> before, after;
  Vector2d before_mean(0, 0), after_mean(0, 0);
  for (std::size_t i = 0; i < disc.size(); ++i) {
    const Vector2d off = reach * disc[i];
    before[i] = picture_of(ball.centre + off);
    after[i] = picture_of(ball.centre + motion.shift + turn * off);
    before_mean += before[i] / static_cast<double>(disc.size());
    after_mean += after[i] / static_cast<double>(disc.size());
  }
  double cosine = 0, sine = 0;  // y points down: a turn on the screen is the other way round
  for (std::size_t i = 0; i < disc.size(); ++i) {
    const Vector2d a = before[i] - before_mean, b = after[i] - after_mean;
    cosine += a.dot(b);
    sine -= a.x() * b.y() - a.y() * b.x();
  }
  TurnInPlane shown;
  shown.angle = std::atan2(sine, cosine);
  // Of the point that is at the circle's centre.
  const Vector2d arm = circle.centre - before_mean;
  shown.shift = after_mean + turned(-shown.angle) * arm - circle.centre;
  return shown;
}

TurnInPlane BallView::motion(const BallInPlane& ball, const CircleInPicture& circle,
                             const TurnInPlane& in_picture) const {
  Matrix2d slope;
  const Vector2d next = plane_.to_plane(circle.centre + in_picture.shift, 0, &slope);
  TurnInPlane found{next - plane_.to_plane(circle.centre), in_picture.angle};
  for (int step = 0; step < kMostSteps; ++step) {
    const TurnInPlane shown = motion_in_picture(ball, circle, found);
    const Vector2d off = in_picture.shift - shown.shift;
    const double turn = std::remainder(in_picture.angle - shown.angle, 2 * kPi);
    found.shift += slope * off;
    found.angle += turn;
    if (!std::isfinite(off.norm() + turn)) break;
    if (off.norm() < kConverged_px && std::abs(turn) < kConverged_rad) return found;
  }
  return {Vector2d::Constant(kNotMeasured), kNotMeasured};
}

}  // namespace impactdic::camera
