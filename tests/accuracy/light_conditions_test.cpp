// Balls as cameras show them, by the same run as a clip's file: no row is wrong with status ok, and
// deviations are what errors are.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "tests/support/tracks/light_tracks.h"

namespace impactdic::testing {
namespace {

constexpr int kFrames = 12;

// A condition, and how exactly centre, radius and displacement are to be known in it.
struct Condition {
  LightScene scene;
  double centre_px, radius_px, shift_px;
};

const Condition kConditions[] = {
    {{.name = "shade", .shading = 0.4}, 0.03, 0.04, 0.001},
    {{.name = "wood", .backdrop = Backdrop::kWood}, 0.03, 0.04, 0.001},
    {{.name = "tiles", .backdrop = Backdrop::kTiles}, 0.08, 0.12, 0.0015},
    {{.name = "slope", .pattern = "b3", .backdrop = Backdrop::kSlope}, 0.03, 0.04, 0.001},
    {{.name = "sphere_slope", .sphere = true, .lamp_share = 0.3, .backdrop = Backdrop::kSlope},
     0.05,
     0.12,
     0.004},
    {{.name = "bar", .hidden = 0.3}, 0.03, 0.05, 0.001},
    {{.name = "upright", .hidden = 0.3, .bar_angle_deg = 90}, 0.03, 0.05, 0.001},
    {{.name = "unseen", .hidden = 0.3, .bar_level = 30}, 0.04, 0.08, 0.001},
    {{.name = "contact", .compression = 0.1, .contact = true}, 0.03, 0.04, 0.001},
    {{.name = "contact_wood", .compression = 0.1, .contact = true, .backdrop = Backdrop::kWood},
     0.03,
     0.04,
     0.0015},
    {{.name = "contact_bar", .hidden = 0.3, .compression = 0.1, .contact = true},
     0.03,
     0.05,
     0.0015},
    {{.name = "mild", .sphere = true, .lamp_share = 0.4, .lamp_elevation_deg = 30},
     0.03,
     0.05,
     0.004},
    {{.name = "half", .sphere = true, .lamp_share = 0.5}, 0.03, 0.08, 0.004},
    {{.name = "sphere_wood", .sphere = true, .lamp_share = 0.3, .backdrop = Backdrop::kWood},
     0.05,
     0.2,
     0.004},
};

class LightConditions : public ::testing::TestWithParam<Condition> {};

TEST_P(LightConditions, NoRowIsWrong) {
  constexpr double kOverSds = 1.6;
  constexpr double kTurn_deg = 0.003;
  const auto& [scene, centre_px, radius_px, shift_px] = GetParam();
  const LightFilm film(scene, 101, kFrames);
  const LightErrors errors = errors_of(track(film), film);
  std::printf("rms, over sd: centre %.4f, %.2f; radius %.4f, %.2f; shift %.4f, %.2f px\n",
              errors.centre.rms(), errors.centre.over_sds(), errors.radius.rms(),
              errors.radius.over_sds(), errors.shift.rms(), errors.shift.over_sds());
  EXPECT_EQ(errors.circles, kFrames);
  EXPECT_EQ(errors.motions, kFrames - 1);
  EXPECT_EQ(errors.wrong, 0);
  EXPECT_LT(errors.centre.rms(), centre_px);
  EXPECT_LT(errors.radius.rms(), radius_px);
  EXPECT_LT(errors.shift.rms(), shift_px);
  EXPECT_LT(std::abs(errors.turn.sum), kTurn_deg);  // of the whole clip, by its steps
  for (const LightErrors::Axis& axis : {errors.centre, errors.radius, errors.shift, errors.turn}) {
    EXPECT_LT(axis.over_sds(), kOverSds);
  }
  if (scene.sphere) {
    EXPECT_LT(errors.tilt.rms(), kTurn_deg);
    EXPECT_LT(errors.tilt.over_sds(), kOverSds);
  } else {
    EXPECT_EQ(errors.pose.count, kFrames - 1);
    EXPECT_LT(errors.pose.rms(), kTurn_deg);
    EXPECT_LT(errors.pose.over_sds(), kOverSds);
  }
}

INSTANTIATE_TEST_SUITE_P(All, LightConditions, ::testing::ValuesIn(kConditions),
                         [](const auto& info) { return std::string(info.param.scene.name); });

}  // namespace
}  // namespace impactdic::testing
