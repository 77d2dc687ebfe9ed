// A ball in free flight that is seen as an ellipse.
#include "host/run/metres/lens/oval_outline.h"

#include <gtest/gtest.h>
#include <impactdic/units.h>

#include <cmath>
#include <random>

namespace impactdic::testing {
namespace {

constexpr int kWidth = 512, kHeight = 400;
constexpr double kRadius = 60;

// Twelve frames down to a floor, four on it, and twelve back, a little to the right. `share`, `at`:
// of pixels that are not square; `readout`: of a rolling shutter, frames; `turn_rad`: by which the
// ball takes its ellipse along from frame to frame.
struct Flights {
  double share = 0, at_rad = 0, readout = 0, turn_rad = 0;

  std::vector<TrackRow> rows(unsigned seed) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 0.015);
    std::vector<TrackRow> rows(28);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      TrackRow& row = rows[i];
      row.frame = static_cast<std::int64_t>(i);
      row.circle_ok = row.motion_ok = true;
      row.cx_px = 200 + 3.0 * static_cast<double>(i), row.cy_px = 200;
      row.dx_px = 3, row.dy_px = i < 12 ? 11 : -9;
      row.r_px = kRadius;
      const double axis = 2 * (at_rad + turn_rad * static_cast<double>(i));
      const double rows_px = kRadius * readout / kHeight / 2;
      row.e1_px = kRadius * share / 2 * std::cos(axis) - rows_px * row.dy_px + noise(random);
      row.e2_px = -kRadius * share / 2 * std::sin(axis) + rows_px * row.dx_px + noise(random);
      row.e1_sd_px = row.e2_sd_px = 0.015;
    }
    return rows;
  }
  std::optional<run::OvalOutline> found(unsigned seed = 1) const {
    ImpactAnalysis analysis;
    analysis.status = ImpactStatus::kFound;
    analysis.before.first = 0, analysis.before.last = 11;
    analysis.after.first = 16, analysis.after.last = 27;
    return run::oval_of_flights(rows(seed), analysis, kWidth, kHeight);
  }
};

TEST(OvalOutline, TellsPixelsThatAreNotSquare) {
  for (const double at : {0.0, 1.0, kPi / 2}) {
    const auto oval = Flights{.share = 0.02, .at_rad = at}.found();
    ASSERT_TRUE(oval) << at;
    EXPECT_NEAR(oval->stretch.value, 0.02, 3 * oval->stretch.sd);
    EXPECT_LT(oval->stretch.sd, 0.0015);
    EXPECT_NEAR(oval->towards_rad, at, 0.05);
    EXPECT_FALSE(oval->follows_speed);
    EXPECT_NE(run::oval_warning(oval).find("2.0"), std::string::npos) << run::oval_warning(oval);
  }
}

TEST(OvalOutline, TellsARollingShutter) {
  const auto oval = Flights{.readout = 0.8}.found();
  ASSERT_TRUE(oval);
  EXPECT_TRUE(oval->follows_speed);
  EXPECT_NEAR(oval->readout_frames.value, 0.8, 3 * oval->readout_frames.sd);
  EXPECT_LT(oval->readout_frames.sd, 0.1);
  EXPECT_NE(run::oval_warning(oval).find("rolling shutter"), std::string::npos);
}

TEST(OvalOutline, ABallThatIsNotRoundTurnsItsEllipse) {
  EXPECT_EQ(run::oval_warning(Flights{.share = 0.02, .turn_rad = 0.4}.found()), "");
}

TEST(OvalOutline, ARoundBallIsNone) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    EXPECT_EQ(run::oval_warning(Flights{}.found(seed)), "") << seed;
  }
}

}  // namespace
}  // namespace impactdic::testing
