// What a chain of registrations says of its errors, against chains that were made with them.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "host/base/statistics.h"
#include "host/dic/sphere/rotation.h"
#include "host/dic/sphere/sphere_errors.h"
#include "host/motion/pose/body_motion.h"
#include "host/motion/pose/turn_closure.h"
#include "host/sphere/source_response.h"

namespace impactdic::motion {
namespace {

constexpr double kRadiusPx = 100;

LinkedPose beginning() {
  LinkedPose pose;
  pose.ok = true;
  pose.x_px = pose.y_px = pose.x_sd_px = pose.y_sd_px = 0;
  pose.tilt_x_sd_rad = pose.tilt_y_sd_rad = pose.angle_sd_rad = 0;
  set_orientation(pose, Eigen::Quaterniond::Identity());
  return pose;
}

dic::RigidMotion turn(const Eigen::Vector3d& vector, double sd_rad) {
  dic::RigidMotion motion;
  motion.ok = true;
  motion.rot_x_rad = vector.x();
  motion.rot_y_rad = vector.y();
  motion.rot_rad = vector.z();
  motion.rot_x_sd_rad = motion.rot_y_sd_rad = sd_rad;
  motion.rot_sd_rad = 0.1 * sd_rad;  // as of a sphere, which tells turns in the picture better
  return motion;
}

Eigen::Vector3d apart(const LinkedPose& a, const LinkedPose& b) {
  return dic::rotation_vector(turn_between(a, b));
}

// A quarter of a turn about X makes errors about Y errors about Z.
TEST(LinkedPose, NoiseTurnsAlongWithTheBall) {
  constexpr int kLinks = 9, kChains = 2000;
  constexpr double kSd = 1e-4;
  const Eigen::Vector3d step(0.5 * kPi / kLinks, 0, 0);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  LinkedPose truth = beginning();
  for (int k = 0; k < kLinks; ++k)
    truth = linked(truth, {}, turn(step, kSd), SphereRadius{kRadiusPx});
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (int chain = 0; chain < kChains; ++chain) {
    LinkedPose pose = beginning();
    for (int k = 0; k < kLinks; ++k) {
      const Eigen::Vector3d noise =
          kSd * Eigen::Vector3d(normal(random), normal(random), 0.1 * normal(random));
      const Eigen::Quaterniond measured = dic::quaternion_of(noise) * dic::quaternion_of(step);
      pose = linked(pose, {}, turn(dic::rotation_vector(measured), kSd), SphereRadius{kRadiusPx});
    }
    squares += apart(truth, pose).cwiseAbs2();
  }
  const Eigen::Vector3d rms = (squares / kChains).cwiseSqrt();
  const BodyPose stated = truth.stated({});
  // 2000 chains know a deviation to 1.6 %.
  EXPECT_NEAR(rms.x() / stated.tilt_x_sd_rad, 1, 0.06);
  EXPECT_NEAR(rms.y() / stated.tilt_y_sd_rad, 1, 0.06);
  EXPECT_NEAR(rms.z() / stated.angle_sd_rad, 1, 0.06);
  EXPECT_GT(stated.angle_sd_rad, 1.5 * kSd);
}

// Every link errs alike: a chain of twice as many has twice the error.
TEST(LinkedPose, TheRadiusErrsAlikeInEveryLink) {
  const dic::RigidMotion step = turn({0.05, 0.08, 0.02}, 0);
  LinkedPose pose = beginning();
  double half = 0;
  for (int k = 0; k < 40; ++k) {
    if (k == 20) half = Eigen::Vector3d(pose.radius_turn_rad.data()).norm();
    pose = linked(pose, {}, step, SphereRadius{kRadiusPx, 0.05});
  }
  EXPECT_NEAR(Eigen::Vector3d(pose.radius_turn_rad.data()).norm() / half, 2, 0.05);
  // Of 40 × 0.096 rad, 0.05 % of the radius makes about twice as large a share.
  EXPECT_NEAR(0.05 * Eigen::Vector3d(pose.radius_turn_rad.data()).norm(), 40 * 0.096 * 1e-3,
              1.5e-3);
}

// So it is with the distance, which moves what is told of a ball that flies, too.
TEST(LinkedPose, TheDistanceErrsAlikeInEveryLink) {
  SphereRadius seen{kRadiusPx};
  seen.perspective.nearness_sd = 0.01;
  const auto sd_after = [&](int links, const dic::RigidMotion& step) {
    LinkedPose pose = beginning();
    for (int k = 0; k < links; ++k) pose = linked(pose, {}, step, seen);
    return pose.stated(seen).tilt_y_sd_rad;
  };
  const dic::RigidMotion turned = turn({0, 0.05, 0}, 0);
  EXPECT_NEAR(sd_after(40, turned) / sd_after(20, turned), 2, 0.05);
  // 0.69 of the turn (least squares over the sphere's visible half).
  EXPECT_NEAR(sd_after(1, turned), 0.69 * 0.01 * 0.05, 0.03 * 0.01 * 0.05);
  dic::RigidMotion flown = turn({0, 0, 0}, 0);
  flown.dx_px = 11.5;
  // The line of sight turns by the flight over the distance.
  EXPECT_NEAR(sd_after(1, flown), 0.01 * 11.5 / kRadiusPx, 1e-6);
}

// Turns that a registration finds with a radius that is too large by `error_px`.
dic::RigidMotion mistaken(const Eigen::Vector3d& vector, double error_px, double sd_rad,
                          std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto response =
      sphere::source_response({{vector.x(), vector.y(), vector.z()}, kRadiusPx, {}, {}});
  const Eigen::Vector3d per_px(response.rot_x[sphere::kToRadius], response.rot_y[sphere::kToRadius],
                               response.rot_z[sphere::kToRadius]);
  const Eigen::Vector3d error =
      error_px * per_px +
      sd_rad * Eigen::Vector3d(normal(random), normal(random), 0.1 * normal(random));
  return turn(dic::rotation_vector(dic::quaternion_of(error) * dic::quaternion_of(vector)), sd_rad);
}

class Closure : public ::testing::TestWithParam<unsigned> {};

// A whole turn in steps, seen once more against its beginning.
TEST_P(Closure, TellsTheRadius) {
  constexpr int kLinks = 50;
  constexpr double kErrorPx = 0.06, kSd = 2e-5;
  std::mt19937_64 random(GetParam());
  const SphereRadius radius{kRadiusPx, 0.05};
  const Eigen::Vector3d step = Eigen::Vector3d(0.5, 0.6, 0.4).normalized() * 2 * kPi / kLinks;
  const auto link = [&](const LinkedPose& pose) {
    dic::RigidMotion motion = mistaken(step, kErrorPx, kSd, random);
    // A step's deviations hold the radius's.
    dic::add_source_errors(motion, {kRadiusPx, radius.told_sd_px});
    return linked(pose, {}, motion, radius);
  };
  LinkedPose truth = beginning(), along = beginning(), half = along;
  for (int k = 0; k < kLinks; ++k) {
    along = link(along);
    if (2 * (k + 1) == kLinks) half = along;
  }
  for (int k = 0; 2 * k < kLinks; ++k) truth = linked(truth, {}, turn(step, 0), radius);
  const LinkedPose closed = link(beginning());
  along = link(along);
  const auto closure = TurnClosure::of(along, closed, beginning(), radius);
  ASSERT_TRUE(closure);
  const SphereRadius better = closure->radius();
  EXPECT_LT(better.sd_px, 0.02);
  EXPECT_NEAR(better.error_px, kErrorPx, 3 * better.sd_px);
  const double before = apart(truth, half).norm();
  const LinkedPose mended = closure->corrected(half);
  EXPECT_LT(apart(truth, mended).norm(), 0.25 * before);
  EXPECT_LT(mended.stated(better).tilt_x_sd_rad, half.stated(radius).tilt_x_sd_rad);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Closure, ::testing::Values(1U, 2U, 3U, 4U, 5U, 6U));

// Radius and distance do nearly the same to a chain. A closure knows what they do together, though
// not which of them it was, and what is left of it is the chain's noise: poses on the far side of
// the turn err by half of what the whole chain's noise makes, and are as good as is stated.
TEST(LinkedPose, AClosureKnowsWhatRadiusAndDistanceDoTogether) {
  constexpr int kLinks = 50, kChains = 100;
  constexpr double kSd = 2e-5;
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  SphereRadius radius{kRadiusPx, 0.05};
  radius.perspective.nearness_sd = 5e-4;
  const Eigen::Vector3d step = Eigen::Vector3d(0.5, 0.6, 0.4).normalized() * 2 * kPi / kLinks;
  LinkedPose truth = beginning();
  for (int k = 0; 2 * k < kLinks; ++k) truth = linked(truth, {}, turn(step, 0), radius);
  double squares = 0, before = 0, stated = 0;
  for (int chain = 0; chain < kChains; ++chain) {
    // As thought to be, so that links are corrected by the opposite: errors that nobody knows.
    SphereRadius wrong = radius;
    wrong.error_px = -radius.sd_px * normal(random);
    wrong.nearness_error = -radius.nearness_sd() * normal(random);
    // Foreshortened texture lets every link err by a share of its turn, too. A closure takes that
    // away and states it nevertheless.
    const Eigen::Vector3d foreshortened = (1 + 4e-5 * normal(random)) * step;
    const auto link = [&](const LinkedPose& pose) {
      const Eigen::Vector3d noise =
          kSd * Eigen::Vector3d(normal(random), normal(random), 0.1 * normal(random));
      const Eigen::Quaterniond seen = dic::quaternion_of(noise) * dic::quaternion_of(foreshortened);
      dic::RigidMotion motion = turn(dic::rotation_vector(seen), kSd);
      dic::add_source_errors(motion, {kRadiusPx, radius.told_sd_px, 0, 0, radius.nearness_sd()});
      return linked(pose, {}, motion, wrong);
    };
    LinkedPose along = beginning(), half = along;
    for (int k = 0; k < kLinks; ++k) {
      along = link(along);
      if (2 * (k + 1) == kLinks) half = along;
    }
    const LinkedPose closed = link(beginning());
    const auto closure = TurnClosure::of(link(along), closed, beginning(), radius);
    ASSERT_TRUE(closure);
    const LinkedPose mended = closure->corrected(half);
    const BodyPose now = mended.stated(closure->radius()), then = half.stated(radius);
    squares += apart(truth, mended).squaredNorm();
    stated += std::pow(now.tilt_x_sd_rad, 2) + std::pow(now.tilt_y_sd_rad, 2) +
              std::pow(now.angle_sd_rad, 2);
    before += std::pow(then.tilt_x_sd_rad, 2) + std::pow(then.tilt_y_sd_rad, 2) +
              std::pow(then.angle_sd_rad, 2);
  }
  std::printf("off by %.2f of stated, %.3f of what was stated before\n",
              std::sqrt(squares / stated), std::sqrt(squares / before));
  EXPECT_NEAR(std::sqrt(squares / stated), 1, 0.1);
  const double bridge = std::sqrt(2.01 * kLinks / 4) * kSd;  // of three axes
  EXPECT_NEAR(std::sqrt(squares / kChains), bridge, 0.1 * bridge);
  EXPECT_LT(stated, 0.1 * before);
}

// However much a closure tells, a pose states what a link errs by.
TEST(LinkedPose, WhatIsToldLeavesADeviation) {
  LinkedPose pose = beginning();
  pose.turn_noise_rad2[0] = 1e-8, pose.turn_told_rad2[0] = 1.1e-8;
  EXPECT_GT(pose.stated(SphereRadius{kRadiusPx}).tilt_x_sd_rad, 1e-5);
}

// Something else than the radius: a ball that was hit in between, another ball.
TEST(LinkedPose, AClosureThatTheRadiusDoesNotExplainTellsNothing) {
  const SphereRadius radius{kRadiusPx, 0.05};
  LinkedPose along = beginning();
  for (int k = 0; k < 50; ++k) {
    along = linked(along, {}, turn({0.06, 0.08, 0.05}, 2e-5), radius);
  }
  LinkedPose closed = beginning();
  set_orientation(closed, dic::quaternion_of({0, 0.1, 0}) * orientation(along));
  EXPECT_FALSE(TurnClosure::of(along, closed, beginning(), radius));
  // Nor do two chains that know the radius's effect alike.
  EXPECT_FALSE(TurnClosure::of(along, along, beginning(), radius));
}

}  // namespace
}  // namespace impactdic::motion
