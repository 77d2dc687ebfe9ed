// What a ball's outline tells of the lens.
#include <gtest/gtest.h>

#include <random>

#include "host/run/metres/lens/lens_check.h"
#include "tests/support/camera/through_lens.h"

namespace impactdic::testing {
namespace {

constexpr int kSide = 512;
constexpr double kMetrePerPx = 3e-4;

// A ball that crosses the picture in 24 frames, `grows` larger at the end than at the beginning as
// it comes nearer; its radius with the noise of a good one.
std::vector<TrackRow> crossing(unsigned seed, double grows = 0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.01);
  std::vector<TrackRow> rows(24);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TrackRow& row = rows[i];
    const double t = static_cast<double>(i) / static_cast<double>(rows.size() - 1);
    row.frame = static_cast<std::int64_t>(i);
    row.circle_ok = true;
    row.cx_px = 70 + 370 * t, row.cy_px = 100 + 300 * t;
    row.r_px = 60 / (1 - grows * t) + noise(random);
    row.cx_sd_px = row.cy_sd_px = row.r_sd_px = 0.01;
  }
  return rows;
}

std::optional<Measured> corner_of(const std::vector<TrackRow>& rows) {
  ImpactAnalysis one_flight;
  one_flight.flight.last = rows.size() - 1;
  return run::corner_by_outline(rows, one_flight, kSide, kSide);
}

std::string warning_of(const std::vector<TrackRow>& rows) {
  return run::outline_warning(corner_of(rows), kSide, kSide, false);
}

TEST(Outline, TellsTheDistortion) {
  for (const double share : {0.02, -0.01, -0.02}) {
    const auto rows =
        through_lens(bent_camera(kSide, kMetrePerPx, share), crossing(1), kMetrePerPx);
    const auto corner = corner_of(rows);
    ASSERT_TRUE(corner);
    // The distortion is taken for a small one, and what is seen for its place.
    EXPECT_NEAR(corner->value, share, 3 * corner->sd + 0.1 * std::abs(share));
    EXPECT_LT(corner->sd, 0.003);
    EXPECT_NE(warning_of(rows).find("impactdic calibrate"), std::string::npos) << share;
  }
}

// Rims that something hides err, and say so.
TEST(Outline, PoorRimsCountForLess) {
  auto rows = through_lens(bent_camera(kSide, kMetrePerPx, -0.02), crossing(5), kMetrePerPx);
  for (std::size_t i = 20; i < rows.size(); ++i) {
    rows[i].r_px += i % 2 == 0 ? 0.15 : -0.15;
    rows[i].r_sd_px = 0.15;
  }
  const auto corner = run::corner_by_outline(rows, {}, kSide, kSide);
  ASSERT_TRUE(corner);
  EXPECT_NEAR(corner->value, -0.02, 3 * corner->sd + 0.002);
}

TEST(Outline, OfABallThatComesNearerTellsNothing) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const double grows : {0.0, 0.05, 0.3}) {
      EXPECT_EQ(warning_of(crossing(seed, grows)), "") << seed << ", " << grows;
    }
  }
}

// A sphere looks larger away from the axis without any lens.
TEST(Outline, OfASphereSeenFromNearByTellsNothing) {
  const auto rows =
      through_lens(bent_camera(kSide, kMetrePerPx, 0), crossing(3), kMetrePerPx, true);
  EXPECT_GT(rows[0].r_px, rows[12].r_px + 0.1);
  EXPECT_EQ(warning_of(rows), "");
}

// A ball that is held and moved towards the camera and back.
TEST(Outline, OfABallInNoFlightTellsNothing) {
  std::vector<TrackRow> rows = crossing(4);
  for (TrackRow& row : rows) row.r_px += 0.5 * std::sin(0.8 * static_cast<double>(row.frame));
  EXPECT_FALSE(run::corner_by_outline(rows, {}, kSide, kSide).has_value());
}

}  // namespace
}  // namespace impactdic::testing
