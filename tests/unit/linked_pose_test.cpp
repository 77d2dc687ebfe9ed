// What a chain of registrations says of its errors, against chains that were made with them.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "host/base/statistics.h"
#include "host/dic/sphere/rotation.h"
#include "host/motion/pose/body_motion.h"

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

}  // namespace
}  // namespace impactdic::motion
