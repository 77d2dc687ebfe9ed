// What an outline's shape does to the motion of a sphere that is registered with it.
#include "host/motion/shape_doubt.h"

#include <gtest/gtest.h>
#include <impactdic/units.h>

#include <cmath>

#include "host/dic/sphere/rotation.h"
#include "host/motion/estimators.h"
#include "host/sphere/picture_blur.h"
#include "tests/support/engine.h"
#include "tests/support/sphere/sphere_pictures.h"

namespace impactdic::motion {
namespace {

using testing::shared_engine;

constexpr int kSide = 157;
constexpr double kRadiusPx = 60;
const Eigen::Vector3d kTurn = Eigen::Vector3d(2, -3, 1.5).normalized() * 4 * kRadPerDeg;

// A ball pressed along y by these shares in both pictures.
class PressedPair {
 public:
  PressedPair(double first, double second) : frames_(shared_engine(), 2) {
    const testing::SpherePictures sphere(6, kRadiusPx);
    testing::SpherePose one{78.2, 77.4, dic::quaternion_of({0.3, -1, 2})};
    testing::SpherePose two{79.57, 76.79, dic::quaternion_of(kTurn) * one.turn};
    one.compression = first;
    two.compression = second;
    frames_.set(0, sphere.render(one, kSide, kSide, 2, 1));
    frames_.set(1, sphere.render(two, kSide, kSide, 2, 2));
  }

  // Registered where outlines tell of ellipses shorter by such shares along y.
  BallMotion measured(double first, double second, double sd) {
    dic::RigidMotion start;
    start.dx_px = 1.3;
    start.dy_px = -0.6;
    start.rot_x_rad = kTurn.x();
    start.rot_y_rad = kTurn.y();
    start.rot_rad = kTurn.z();
    BallTask task = sphere_task({78.2, 77.4, kRadiusPx}, kRadiusPx, sphere::kUsualBlur_px2, start);
    task.second = 1;
    task.sight.first[2] = static_cast<float>(-first);
    task.sight.second[2] = static_cast<float>(-second);
    dic::BallRegistration registration(shared_engine(),
                                       ball_options(FieldOptions{}, dic::BallModel::kSphere));
    BallMotion motion = registration.measure(frames_, {&task, 1})[0];
    const ShapedPair pair{
        task, &motion, {BallShape{first / 2, 0, sd}, BallShape{second / 2, 0, sd}}};
    doubt_shapes(registration, frames_, {&pair, 1});
    return motion;
  }

 private:
  dic::DeviceFrames frames_;
};

double off_px(const BallMotion& motion) { return std::hypot(motion.dx - 1.37, motion.dy + 0.61); }

TEST(ShapeDoubt, AnEllipseThatTheBallHasNotIsNotTaken) {
  PressedPair round(0, 0);
  const BallMotion right = round.measured(0, 0, 0), told = round.measured(0, 0.03, 0.005);
  EXPECT_LT(off_px(right), 0.02);
  EXPECT_NEAR(told.dx, right.dx, 1e-3);
  EXPECT_NEAR(told.dy, right.dy, 1e-3);
  EXPECT_NEAR(told.rot_x_rad, right.rot_x_rad, 2e-5);
}

TEST(ShapeDoubt, WhatAnOutlineErrsByIsPartOfTheDeviations) {
  PressedPair pressed(0.03, 0.05);
  const BallMotion right = pressed.measured(0.03, 0.05, 1e-6),
                   off = pressed.measured(0.03, 0.045, 0.003);
  EXPECT_LT(off_px(right), 0.02);
  const BallMotion sure = pressed.measured(0.03, 0.045, 1e-6);
  EXPECT_GT(off.covariance[2], 2 * sure.covariance[2]);
  EXPECT_GT(off.covariance[5], 2 * sure.covariance[5]);
  const double sd = std::sqrt(off.covariance[2]), before = std::sqrt(right.covariance[2]);
  EXPECT_GT(std::abs(off.dy + 0.61), 5 * before);
  EXPECT_LT(std::abs(off.dy + 0.61), 3 * sd);
  EXPECT_LT(std::abs(off.rot_x_rad - kTurn.x()), 3 * std::sqrt(off.covariance[5]));
}

// Beside a contact an outline looks round that is not: the motion is off by 0.36 px, four
// deviations.
TEST(ShapeDoubt, ABallThatLooksRoundMayBePressedALittle) {
  PressedPair pressed(0, 0.008);
  const BallMotion sure = pressed.measured(0, 0, 1e-6), doubted = pressed.measured(0, 0, 0.004);
  EXPECT_EQ(doubted.dy, sure.dy);
  EXPECT_GT(std::abs(sure.dy + 0.61), 3 * std::sqrt(sure.covariance[2]));
  EXPECT_LT(std::abs(doubted.dy + 0.61), 2 * std::sqrt(doubted.covariance[2]));
}

}  // namespace
}  // namespace impactdic::motion
