// Where a sphere's centre is seen, and what a registration is told of how it is seen.
#include "host/motion/perspective.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace impactdic::testing {
namespace {

using motion::about_centre;
using motion::BallShape;
using motion::Perspective;
using motion::sight_of;

constexpr double kDistance_px = 1000, kAxisX_px = 255.5, kAxisY_px = 200;

// In the plane through the eye, the axis and the centre the lines of sight that touch the sphere
// lie by the angle asin(R/d) to both sides of that to the centre: the outline's ends.
TEST(Perspective, TheOutlineOfASphereIsAboutAnotherPointThanItsCentre) {
  constexpr double kRadius = 120, kBesides = 300;
  const double to_centre = std::atan2(kBesides, kDistance_px);
  const double half = std::asin(kRadius / std::hypot(kBesides, kDistance_px));
  const double far = kDistance_px * std::tan(to_centre + half);
  const double near = kDistance_px * std::tan(to_centre - half);
  // Straight on the axis the outline's radius is this.
  const double outline = kRadius / std::sqrt(1 - std::pow(kRadius / kDistance_px, 2));
  const Perspective perspective{1 / kDistance_px, kAxisX_px, kAxisY_px};
  const Circle seen{kAxisX_px + (far + near) / 2, kAxisY_px, outline};
  EXPECT_GT(seen.cx_px - kAxisX_px, kBesides + 4);
  const Circle ball = about_centre(seen, perspective);
  EXPECT_NEAR(ball.cx_px, kAxisX_px + kBesides, 1e-9);
  EXPECT_NEAR(ball.cy_px, kAxisY_px, 1e-12);
}

TEST(Perspective, ParallelRaysMoveNothing) {
  const Circle seen{17.25, 300.5, 60};
  const Circle ball = about_centre(seen, {});
  EXPECT_EQ(ball.cx_px, seen.cx_px);
  EXPECT_EQ(ball.cy_px, seen.cy_px);
}

bool is_plain(const BallSight& sight) {
  const float all[] = {sight.by_distance, sight.first_x,   sight.first_y,  sight.second_x,
                       sight.second_y,    sight.first[0],  sight.first[1], sight.first[2],
                       sight.second[0],   sight.second[1], sight.second[2]};
  return std::all_of(std::begin(all), std::end(all), [](float x) { return x == 0; });
}

// What is round but for chance is registered as a round ball, to the last bit.
TEST(Perspective, ARoundBallUnderParallelRaysIsPlain) {
  const Circle circle{100, 90, 60};
  EXPECT_TRUE(is_plain(sight_of({}, 60, {circle, {}}, {circle, {}}, 100, 90)));
  const BallShape chance{0.003, 0.001, 0.001};
  EXPECT_TRUE(is_plain(sight_of({}, 60, {circle, chance}, {circle, {}}, 100, 90)));
}

// At a touch a pressing of 0.1 px put a sphere of 60 px 0.2 px off, where it was called round.
TEST(Perspective, AShapeBeyondChanceIsStretchedHoweverSmall) {
  const Circle circle{100, 90, 60};
  const BallShape small{0.001, 0.0005, 1e-5};
  const BallSight sight = sight_of({}, 60, {circle, {}}, {circle, small}, 100, 90);
  for (const float strain : sight.first) EXPECT_EQ(strain, 0);
  EXPECT_NEAR(sight.second[0], 0.001, 1e-6);
  EXPECT_NEAR(sight.second[1], 0.0005, 1e-6);
}

// A ball that is 6 % shorter along y has an outline of the mean radius 0.97.
TEST(Perspective, TheStretchIsThatOfTheOutlines) {
  const Circle round{100, 90, 60}, flat{101, 90, 58.2};
  const BallShape shape{0.03 / 0.97, 0, 1e-4};
  const BallSight sight = sight_of({}, 60, {round, {}}, {flat, shape}, 100, 90);
  for (const float strain : sight.first) EXPECT_EQ(strain, 0);
  EXPECT_NEAR(sight.second[0], 0, 1e-6);
  EXPECT_NEAR(sight.second[1], 0, 1e-6);
  EXPECT_NEAR(sight.second[2], -0.06, 1e-6);
}

// The second part lies elsewhere in its frame.
TEST(Perspective, BothPicturesAreSeenFromTheirOwnPlaces) {
  const Perspective perspective{1 / kDistance_px, kAxisX_px, kAxisY_px};
  const Circle first{355.5, 150, 60};
  const BallSight sight = sight_of(perspective, 60, {first, {}}, {first, {}}, 371.5, 118);
  EXPECT_FLOAT_EQ(sight.by_distance, 1e-3F);
  EXPECT_FLOAT_EQ(sight.first_x, 0.1F);
  EXPECT_FLOAT_EQ(sight.first_y, -0.05F);
  EXPECT_FLOAT_EQ(sight.second_x, 0.116F);
  EXPECT_FLOAT_EQ(sight.second_y, -0.082F);
}

}  // namespace
}  // namespace impactdic::testing
