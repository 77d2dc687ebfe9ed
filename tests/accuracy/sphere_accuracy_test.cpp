// How exactly the registration of a sphere measures turns about any axis, and whether large ones
// are found.
#include <gtest/gtest.h>

#include "tests/support/sphere_pairs.h"

namespace impactdic::testing {
namespace {

TEST(SphereAccuracy, PairsAboutAnyAxis) {
  const Summary got = measure_pairs(20, 8, 2, 5);
  EXPECT_EQ(got.lost, 0);
  EXPECT_LE(got.shift.rms(), 0.0020);
  EXPECT_LE(got.in_depth_deg.rms(), 0.0018);
  EXPECT_LE(got.about_sight_deg.rms(), 0.0007);
  EXPECT_NEAR(got.shift.rms_over_sd(), 1, 0.35);
  EXPECT_NEAR(got.in_depth_deg.rms_over_sd(), 1, 0.35);
}

// As parallel rays have it, a turn of 2 degrees would read 2.09.
TEST(SphereAccuracy, PairsFromNearBy) {
  const Summary got = measure_pairs(12, 2, 2, 6, {25, 0});
  EXPECT_EQ(got.lost, 0);
  EXPECT_LE(got.shift.rms(), 0.0020);
  EXPECT_LE(got.in_depth_deg.rms(), 0.0020);
  EXPECT_LE(got.about_sight_deg.rms(), 0.0007);
  EXPECT_NEAR(got.shift.rms_over_sd(), 1, 0.35);
  EXPECT_NEAR(got.in_depth_deg.rms_over_sd(), 1, 0.35);
}

TEST(SphereAccuracy, PairsOfACompressedBall) {
  const Summary got = measure_pairs(12, 2, 2, 7, {0, 0.05});
  EXPECT_EQ(got.lost, 0);
  EXPECT_LE(got.shift.rms(), 0.0020);
  EXPECT_LE(got.in_depth_deg.rms(), 0.0020);
  EXPECT_LE(got.about_sight_deg.rms(), 0.0007);
  EXPECT_NEAR(got.shift.rms_over_sd(), 1, 0.35);
}

TEST(SphereSearch, FindsAnyTurn) {
  for (const double step : {20.0, 60.0, 90.0, 120.0, 180.0}) {
    EXPECT_EQ(count_found(12, step, 3, 3), 12) << step;
  }
}

}  // namespace
}  // namespace impactdic::testing
