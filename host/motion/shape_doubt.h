// What the outlines of compressed spheres leave open of their motions.
#pragma once

#include <array>
#include <span>

#include "host/dic/device/ball.h"
#include "host/motion/ball_shape.h"

namespace impactdic::motion {

inline constexpr double kPressed = 0.01;  // of the radius
// Whether an outline may hide that the ball is pressed.
inline bool hides_shape(const BallShape& shape) { return shape.is_circle() && shape.sd > kPressed; }

// A pair of a sphere in or beside a contact, registered with the shapes of its outlines as far as
// they show: its task, what came of it, and the shapes in both pictures.
struct ShapedPair {
  BallTask task;
  BallMotion* motion = nullptr;
  std::array<BallShape, 2> shapes;
};

// Outlines err, and an obstacle's edge may look like a compressed ball's: a pair that fits its
// pictures better as a round ball is taken for that. A ball that is pressed a little looks round,
// too. The covariance gets what the deviations of the shapes do to the motion, by registering the
// pair with each figure of the shapes changed by its deviation: in either picture, or, where both
// outlines hide a shape, in both alike and by a part of it in one of them.
void doubt_shapes(dic::BallRegistration& registration, dic::DeviceFrames& frames,
                  std::span<const ShapedPair> pairs);

}  // namespace impactdic::motion
