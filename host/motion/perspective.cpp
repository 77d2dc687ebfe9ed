#include "host/motion/perspective.h"

#include <cmath>

namespace impactdic::motion {
namespace {

constexpr double kBeyondChance = 5;

bool is_round(const BallShape& shape) {
  return !(std::hypot(shape.e1, shape.e2) > kBeyondChance * shape.sd);
}

void put_stretch(const SeenBall& ball, double rim_px, float* stretch) {
  const double size = ball.shape.is_circle() ? 1 : ball.circle.r_px / rim_px;
  stretch[0] = static_cast<float>(size * (1 + ball.shape.e1) - 1);
  stretch[1] = static_cast<float>(size * ball.shape.e2);
  stretch[2] = static_cast<float>(size * (1 - ball.shape.e1) - 1);
}

}  // namespace

Circle about_centre(const Circle& outline, const Perspective& perspective) {
  if (!perspective) return outline;
  const double nearer = std::pow(outline.r_px * perspective.by_distance_per_px, 2);
  // (R/D)² = (r/f)² / (1 + (r/f)²) of an outline of radius r.
  const double back = 1 / (1 + nearer);
  Circle circle = outline;
  circle.cx_px = perspective.axis_x_px + back * (outline.cx_px - perspective.axis_x_px);
  circle.cy_px = perspective.axis_y_px + back * (outline.cy_px - perspective.axis_y_px);
  return circle;
}

BallSight sight_of(const Perspective& perspective, double rim_px, const SeenBall& first,
                   const SeenBall& second, double second_x_px, double second_y_px) {
  BallSight sight{};
  const double k = perspective.by_distance_per_px;
  if (perspective) {
    sight.by_distance = static_cast<float>(k);
    sight.first_x = static_cast<float>(k * (first.circle.cx_px - perspective.axis_x_px));
    sight.first_y = static_cast<float>(k * (first.circle.cy_px - perspective.axis_y_px));
    sight.second_x = static_cast<float>(k * (second_x_px - perspective.axis_x_px));
    sight.second_y = static_cast<float>(k * (second_y_px - perspective.axis_y_px));
  }
  if (is_round(first.shape) && is_round(second.shape)) return sight;
  put_stretch(first, rim_px, sight.first);
  put_stretch(second, rim_px, sight.second);
  return sight;
}

}  // namespace impactdic::motion
