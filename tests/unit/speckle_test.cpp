#include <gtest/gtest.h>

#include <cmath>

#include "sim/speckle/render.h"

namespace impactdic {
namespace {

// Ink at the right of the ball goes up when the ball turns counter-clockwise.
TEST(Render, PositiveRotationIsCounterClockwiseOnTheScreen) {
  SpeckleBall ball{50, {{30, 0, 5}}, {}};
  Scene scene;
  scene.width = scene.height = 121;
  const BallRenderer renderer(ball, scene);
  EXPECT_NEAR(renderer.exact(BallPose{60, 60, 0})(90, 60), scene.ink, 0.01);
  const Image<double> turned = renderer.exact(BallPose{60, 60, 90});
  EXPECT_NEAR(turned(60, 30), scene.ink, 0.01);
  EXPECT_NEAR(turned(90, 60), scene.white, 0.01);
}

}  // namespace
}  // namespace impactdic
