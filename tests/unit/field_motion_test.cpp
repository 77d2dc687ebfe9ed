// From windows and their displacements to a motion of the ball.
#include "host/motion/field_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace impactdic {
namespace {

TEST(AimWindows, TurnsCounterClockwiseOnTheScreen) {
  // One window to the right of the centre: turning counter-clockwise carries it up, to smaller y.
  std::vector<Window> windows(1);
  windows[0].x0 = 193;
  windows[0].y0 = 93;
  motion::aim_windows(windows, 15, 2, 3, {100, 100, 5, 0, 0.1});
  EXPECT_EQ(windows[0].first, 2);
  EXPECT_EQ(windows[0].second, 3);
  EXPECT_EQ(windows[0].guess_v, std::lround(-100 * std::sin(0.1)));
  EXPECT_EQ(windows[0].guess_u, std::lround(5 + 100 * (std::cos(0.1) - 1)));
  EXPECT_FLOAT_EQ(windows[0].guess_rot_rad, 0.1f);
}

TEST(FieldPoints, TakesMeasuredWindowsAtTheirCentres) {
  std::vector<Window> windows(2);
  windows[0].x0 = 10;
  windows[0].y0 = 20;
  std::vector<WindowMotion> motions(2);
  motions[0].u = 1.5f;
  motions[0].u_sd = motions[0].v_sd = 1e-6f;
  motions[1].status = static_cast<idic_int>(WindowStatus::kLowCorrelation);
  const auto points = motion::field_points(windows, motions, 15, 0.002);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].x_px, 17);
  EXPECT_EQ(points[0].y_px, 27);
  EXPECT_EQ(points[0].u_px, 1.5);
  EXPECT_EQ(points[0].sd_px, 0.002);
}

TEST(InterpolateAt, FollowsALinearFieldThroughWrongWindows) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.005);
  std::vector<dic::PointMotion> points;
  for (int i = 0; i < 100; ++i) {
    const double x = 8.0 * (i % 10), y = 8.0 * (i / 10);
    points.push_back(
        {x, y, 1 + 0.01 * x - 0.02 * y + noise(random), 2 + 0.03 * x + noise(random), 0.005});
    if (i % 7 == 3) points.back().u_px += 4;  // found at a wrong place
  }
  const motion::CentreMotion centre = motion::interpolate_at(points, 33.3, 41.7);
  ASSERT_TRUE(centre.ok);
  // Five sd of the noise averaged over the nearest windows.
  EXPECT_NEAR(centre.u_px, 1 + 0.01 * 33.3 - 0.02 * 41.7, 5 * 0.005 / 3);
  EXPECT_NEAR(centre.v_px, 2 + 0.03 * 33.3, 5 * 0.005 / 3);
  EXPECT_GT(centre.u_sd_px, 0.0005);
  EXPECT_LT(centre.u_sd_px, 0.005);
}

TEST(InterpolateAt, FewOrCollinearPointsGiveNothing) {
  std::vector<dic::PointMotion> line;
  for (int i = 0; i < 3; ++i) line.push_back({1.0 * i, 0, 1, 1, 0.01});
  EXPECT_FALSE(motion::interpolate_at(line, 0, 0).ok);
  for (int i = 3; i < 9; ++i) line.push_back({1.0 * i, 0, 1, 1, 0.01});
  EXPECT_FALSE(motion::interpolate_at(line, 0, 0).ok);
}

TEST(ExplainFailure, NamesTheCommonestReason) {
  std::vector<WindowMotion> motions(4);
  for (WindowMotion& m : motions) m.status = static_cast<idic_int>(WindowStatus::kNoTexture);
  EXPECT_EQ(motion::explain_failure(motions), TrackStatus::kNoTexture);
  for (int i = 0; i < 3; ++i) motions[i].status = static_cast<idic_int>(WindowStatus::kOutOfView);
  EXPECT_EQ(motion::explain_failure(motions), TrackStatus::kOutOfView);
  for (int i = 0; i < 3; ++i) {
    motions[i].status = static_cast<idic_int>(WindowStatus::kLowCorrelation);
  }
  EXPECT_EQ(motion::explain_failure(motions), TrackStatus::kLowCorrelation);
}

}  // namespace
}  // namespace impactdic
