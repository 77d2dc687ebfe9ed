#include "host/advice/turned_paint.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/dic/frames/bspline.h"
#include "host/dic/sphere/rotation.h"
#include "host/dic/sphere/sphere_sight.h"

namespace impactdic::advice {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr double kAcross = 56;    // places across the ball
constexpr double kFacing = 0.25;  // cosine of the surface's angle to the line of sight, at least
constexpr int kDegree = 3;        // of the spline
constexpr double kSmooth_px = 1;  // a place stands for its surroundings

std::array<double, 3> normal(const Vector3d& at, double radius) {
  return {at.x() / radius, at.y() / radius, at.z() / radius};
}

}  // namespace

std::vector<sphere::CarriedPaint> turned_paint(const Frame& first, const Frame& second,
                                               const BallMotion& found,
                                               const motion::Perspective& seen) {
  const dic::BSplineImage f(dic::to_double(first), kDegree, kSmooth_px);
  const dic::BSplineImage g(dic::to_double(second), kDegree, kSmooth_px);
  const double radius = found.ball_radius, k = found.by_distance;
  const Vector2d centre(found.cx, found.cy), shift(found.dx, found.dy);
  const Vector2d aside = k * (centre - Vector2d(seen.axis_x_px, seen.axis_y_px));
  const dic::SphereSight before{k, aside}, after{k, aside + k * shift};
  const Eigen::Matrix3d turn =
      dic::in_picture(dic::quaternion_of({found.rot_x_rad, found.rot_y_rad, found.rot_rad}));
  const int step = std::max(1, static_cast<int>(std::lround(2 * radius / kAcross)));
  std::vector<sphere::CarriedPaint> paint;
  for (double y = -radius; y < radius; y += step) {
    for (double x = -radius; x < radius; x += step) {
      const Vector2d p(x, y);
      const Vector3d at = before.on_ball(p, radius), then = turn * at;
      if (!(p.norm() < radius) || before.facing(at, radius) < kFacing ||
          after.facing(then, radius) < kFacing) {
        continue;
      }
      const Vector2d from = centre + p, to = centre + shift + after.picture(then);
      const auto in_view = [&](const Vector2d& place) {
        return place.minCoeff() >= 0 && place.x() <= f.width() - 1 && place.y() <= f.height() - 1;
      };
      if (!in_view(from) || !in_view(to)) continue;
      paint.push_back({normal(at, radius), normal(then, radius), f.value(from.x(), from.y()),
                       g.value(to.x(), to.y())});
    }
  }
  return paint;
}

std::vector<sphere::SeenPaint> seen_paint(const Frame& picture, const Circle& ball) {
  const dic::BSplineImage image(dic::to_double(picture), kDegree, kSmooth_px);
  const double radius = ball.r_px;
  const int step = std::max(1, static_cast<int>(std::lround(2 * radius / kAcross)));
  std::vector<sphere::SeenPaint> paint;
  for (double y = -radius; y < radius; y += step) {
    for (double x = -radius; x < radius; x += step) {
      const double z = std::sqrt(std::max(0.0, radius * radius - x * x - y * y));
      const double at_x = ball.cx_px + x, at_y = ball.cy_px + y;
      if (z < kFacing * radius || at_x < 0 || at_y < 0 || at_x > image.width() - 1 ||
          at_y > image.height() - 1) {
        continue;
      }
      paint.push_back({normal({x, y, z}, radius), image.value(at_x, at_y)});
    }
  }
  return paint;
}

}  // namespace impactdic::advice
