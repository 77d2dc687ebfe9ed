// How a sphere is seen: from near by, and with the shape that its outlines show.
#pragma once

#include <array>

#include "host/circle/circle.h"
#include "host/motion/ball_shape.h"
#include "kernels/types.h"

namespace impactdic::motion {

// The radius over the distance of balls whose distance is not known, rms: a laboratory's camera
// stands 15 radii away or more, and most of them farther.
inline constexpr double kUnknownNearness = 0.03;

// Of a camera without distortion. by_distance_per_px: one over its distance from the ball, a px
// being one of the ball at its centre's depth; 0: parallel rays. The optical axis in the frames.
// nearness_sd: deviation of the ball's radius over that distance.
struct Perspective {
  double by_distance_per_px = 0;
  double axis_x_px = 0, axis_y_px = 0;
  double nearness_sd = 0;

  explicit operator bool() const { return by_distance_per_px > 0; }
  // Whether nobody has told the distance.
  bool is_unknown() const { return nearness_sd >= kUnknownNearness; }
  // From the axis to a place in the frames.
  std::array<double, 2> aside_px(double x_px, double y_px) const {
    return {x_px - axis_x_px, y_px - axis_y_px};
  }
};

// The circle about the picture of a sphere's centre, for one about its outline: off the optical
// axis these are apart. The outline is an ellipse about D² / (D² − R²) of the way from the axis to
// the centre, as the cone of lines of sight that touch the sphere has it.
Circle about_centre(const Circle& outline, const Perspective& perspective);

// A ball in a frame: `circle` about its centre, `shape` and radius as its outline shows them.
struct SeenBall {
  Circle circle;
  BallShape shape;
};

// Of a sphere that is registered from `first` to `second`. `rim_px`: radius of its outline where it
// is round. `second_x_px`, `second_y_px`: of the ball's centre in the second frame where its part
// shows it at the same place as the first one's does (BallSight::second_x).
BallSight sight_of(const Perspective& perspective, double rim_px, const SeenBall& first,
                   const SeenBall& second, double second_x_px, double second_y_px);

}  // namespace impactdic::motion
