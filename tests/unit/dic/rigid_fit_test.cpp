// The robust rigid motion of a displacement field.
#include "host/dic/rigid_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace impactdic {
namespace {

struct Truth {
  double dx, dy, rot_rad;  // of (cx, cy), counter-clockwise on the screen
};
constexpr double kCx = 250, kCy = 240;

std::vector<dic::PointMotion> make_points(const Truth& truth, double noise_px, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 1);
  std::vector<dic::PointMotion> points;
  for (int j = -5; j <= 5; ++j) {
    for (int i = -5; i <= 5; ++i) {
      const double x = 15.0 * i, y = 15.0 * j;
      // Counter-clockwise on the screen with y down: right goes up, which is smaller y.
      const double c = std::cos(truth.rot_rad), s = std::sin(truth.rot_rad);
      points.push_back({kCx + x, kCy + y, truth.dx + c * x + s * y - x + noise_px * noise(random),
                        truth.dy - s * x + c * y - y + noise_px * noise(random),
                        noise_px > 0 ? noise_px : 0.01});
    }
  }
  return points;
}

TEST(RigidFit, IsExactForAnyRotation) {
  for (double degrees : {0.0, 0.01, 3.0, 40.0, 170.0, -90.0}) {
    const Truth truth{1.37, -2.61, degrees * M_PI / 180};
    const dic::RigidMotion motion = dic::fit_rigid_motion(make_points(truth, 0, 1), kCx, kCy);
    ASSERT_TRUE(motion.ok);
    EXPECT_NEAR(motion.dx_px, truth.dx, 1e-10) << degrees;
    EXPECT_NEAR(motion.dy_px, truth.dy, 1e-10) << degrees;
    EXPECT_NEAR(motion.rot_rad, truth.rot_rad, 1e-12) << degrees;
    EXPECT_EQ(motion.used, 121);
  }
}

// A ball that is compressed by 1.5 px/frame along an inclined axis, with bad windows on one side.
TEST(RigidFit, AStrainDoesNotMoveTheCentre) {
  const Truth truth{0.6, 1.8, 0.002};
  constexpr double kNoise = 0.004, kStrain = 0.01, kAxis = 1.2;
  auto points = make_points(truth, kNoise, 7);
  for (dic::PointMotion& p : points) {
    const double along = (p.x_px - kCx) * std::cos(kAxis) + (p.y_px - kCy) * std::sin(kAxis);
    p.u_px -= kStrain * along * std::cos(kAxis);
    p.v_px -= kStrain * along * std::sin(kAxis);
    if (p.y_px > kCy + 60) p.u_px += 2;
  }
  const dic::RigidMotion motion = dic::fit_rigid_motion(points, kCx, kCy);
  ASSERT_TRUE(motion.ok);
  // Five deviations; about a hundred good points.
  EXPECT_NEAR(motion.dx_px, truth.dx, 5 * kNoise / 9);
  EXPECT_NEAR(motion.dy_px, truth.dy, 5 * kNoise / 9);
  EXPECT_NEAR(motion.rot_rad, truth.rot_rad, 5 * kNoise / (50 * 9) + kStrain * truth.rot_rad);
  EXPECT_LT(motion.dx_sd_px, 2 * kNoise / 9);
}

TEST(RigidFit, CounterClockwiseOnTheScreenIsPositive) {
  // A point right of the centre moving up the screen.
  std::vector<dic::PointMotion> points = {
      {10, 0, 0, -1, .01}, {-10, 0, 0, 1, .01}, {0, 0, 0, 0, .01}};
  EXPECT_GT(dic::fit_rigid_motion(points, 0, 0).rot_rad, 0);
}

TEST(RigidFit, StandsFortyPercentOfWrongPoints) {
  const Truth truth{0.5, 1.25, 0.05};
  auto points = make_points(truth, 0.01, 2);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-8, 8);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % 5 >= 2) continue;
    points[i].u_px = anywhere(random);
    points[i].v_px = anywhere(random);
  }
  const dic::RigidMotion motion = dic::fit_rigid_motion(points, kCx, kCy);
  ASSERT_TRUE(motion.ok);
  // Five times the standard deviation that 72 good points allow.
  EXPECT_NEAR(motion.dx_px, truth.dx, 5 * 0.01 / std::sqrt(72));
  EXPECT_NEAR(motion.dy_px, truth.dy, 5 * 0.01 / std::sqrt(72));
  EXPECT_NEAR(motion.rot_rad, truth.rot_rad, 5 * 0.01 / (67 * std::sqrt(72)));
}

TEST(RigidFit, StandardDeviationsAreHonest) {
  const Truth truth{0.3, -0.7, 0.02};
  constexpr int kTrials = 400;
  // Measured off the points' centroid, where rotation and translation are correlated.
  constexpr double kOffX = 30, kOffY = -20;
  double chi_x = 0, chi_y = 0, chi_rot = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const dic::RigidMotion motion =
        dic::fit_rigid_motion(make_points(truth, 0.02, 100u + trial), kCx + kOffX, kCy + kOffY);
    const double c = std::cos(truth.rot_rad), s = std::sin(truth.rot_rad);
    const double dx = truth.dx + c * kOffX + s * kOffY - kOffX;
    const double dy = truth.dy - s * kOffX + c * kOffY - kOffY;
    chi_x += std::pow((motion.dx_px - dx) / motion.dx_sd_px, 2);
    chi_y += std::pow((motion.dy_px - dy) / motion.dy_sd_px, 2);
    chi_rot += std::pow((motion.rot_rad - truth.rot_rad) / motion.rot_sd_rad, 2);
  }
  // Variance of normalised errors: 1 within 15 % (two sd of its own estimate over 400 trials).
  EXPECT_NEAR(chi_x / kTrials, 1, 0.15);
  EXPECT_NEAR(chi_y / kTrials, 1, 0.15);
  EXPECT_NEAR(chi_rot / kTrials, 1, 0.15);
}

TEST(RigidFit, TooFewOrCoincidentPointsAreNotOk) {
  EXPECT_FALSE(dic::fit_rigid_motion({}, 0, 0).ok);
  const std::vector<dic::PointMotion> two = {{0, 0, 1, 1, .1}, {5, 0, 1, 1, .1}};
  EXPECT_FALSE(dic::fit_rigid_motion(two, 0, 0).ok);
  const std::vector<dic::PointMotion> same(4, {3, 3, 1, 1, .1});
  EXPECT_FALSE(dic::fit_rigid_motion(same, 0, 0).ok);
}

}  // namespace
}  // namespace impactdic
