// How exactly the registration of a sphere measures turns about any axis, and whether large ones
// are found.
#include <gtest/gtest.h>

#include "tests/support/sphere/sphere_distances.h"

namespace impactdic::testing {
namespace {

void expect_exact(const Summary& got, double in_depth_deg) {
  EXPECT_EQ(got.lost, 0);
  EXPECT_LE(got.shift.rms(), 0.0020);
  EXPECT_LE(got.in_depth_deg.rms(), in_depth_deg);
  EXPECT_LE(got.about_sight_deg.rms(), 0.0007);
  EXPECT_NEAR(got.shift.rms_over_sd(), 1, 0.35);
  EXPECT_NEAR(got.in_depth_deg.rms_over_sd(), 1, 0.35);
}

TEST(SphereAccuracy, PairsAboutAnyAxis) { expect_exact(measure_pairs(20, 8, 2, 5), 0.0018); }

// As parallel rays have it, a turn of 2 degrees would read 2.09.
TEST(SphereAccuracy, PairsFromNearBy) { expect_exact(measure_pairs(12, 2, 2, 6, {25, 0}), 0.0020); }

TEST(SphereAccuracy, PairsOfACompressedBall) {
  expect_exact(measure_pairs(12, 2, 2, 7, {0, 0.05}), 0.0020);
}

// Radius over distance, of pairs turned by 25 degrees; not told.
TEST(SphereAccuracy, PairsTellFromWhereTheyAreSeen) {
  for (const double radii : {0.0, 25.0}) {
    const DistancesFound found = measure_distances(6, {radii, 25}, 8);
    EXPECT_EQ(found.lost, 0);
    EXPECT_LE(found.nearness.rms(), 0.001);
    EXPECT_LE(found.radius_px.rms(), 0.1);
  }
}

TEST(SphereSearch, FindsAnyTurn) {
  for (const double step : {20.0, 60.0, 90.0, 120.0, 180.0}) {
    EXPECT_EQ(count_found(12, step, 3, 3), 12) << step;
  }
}

}  // namespace
}  // namespace impactdic::testing
