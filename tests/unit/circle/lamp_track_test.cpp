// Tracks of balls in the light of a lamp, by the same run as a clip's file.
#include <gtest/gtest.h>

#include <cstdio>
#include <utility>

#include "tests/support/tracks/light_tracks.h"

namespace impactdic::testing {
namespace {

// Light that stays where it is while the ball turns looks like depth: the radius that turns tell is
// off by a quarter of a pixel under this lamp, and every motion with it.
TEST(LampTrack, AMotionUnderAHardLampIsAsUnsureAsItsRadius) {
  const LightScene scene{.name = "hard",
                         .sphere = true,
                         .lamp_share = 0.9,
                         .lamp_elevation_deg = 20,
                         .limb_darkening = 0.3};
  const LightFilm clip(scene, 9, 12);
  const LightErrors errors = errors_of(track(clip), clip);
  EXPECT_EQ(errors.circles, 12);
  EXPECT_EQ(errors.wrong, 0);
  EXPECT_LT(errors.shift.over_sds(), 1.4);
}

// What a lamp bends is the rim: circles under these lamps are 0.02 and 0.09 px off. A turn of the
// ball carries its paint about its centre, wherever the rim seems to be.
TEST(LampTrack, ASpheresCentreIsTheOneThatItsTurnsTell) {
  LightScene half{.name = "half", .sphere = true, .lamp_share = 0.5}, hard = half;
  hard.lamp_share = 0.9;
  hard.limb_darkening = 0.3;
  for (const auto& [scene, centre_px] : {std::pair(half, 0.012), std::pair(hard, 0.05)}) {
    const LightFilm clip(scene, 104, 12);
    const LightErrors by_turns = errors_of(track(clip), clip);
    const LightErrors by_circles = errors_of(track(clip, false), clip);
    std::printf("centre by turns %.4f px (%.2f of what is stated), by circles %.4f px\n",
                by_turns.centre.rms(), by_turns.centre.over_sds(), by_circles.centre.rms());
    EXPECT_EQ(by_turns.circles, 12);
    EXPECT_EQ(by_turns.wrong, 0);
    EXPECT_LT(by_turns.centre.rms(), centre_px);
    EXPECT_LT(by_turns.centre.over_sds(), 1.6);
    EXPECT_LT(by_turns.centre.rms(), 0.8 * by_circles.centre.rms());
  }
}

// White that is cut off at the end of the camera's scale leaves half of it unknown: circles were
// 0.155 px too large, with 0.013 px stated where crossings alone told them.
TEST(LampTrack, AnOverExposedBallIsNotSureOfItsRadius) {
  const LightFilm clip({.name = "over", .gain = 1.5}, 39, 12);
  const LightErrors errors = errors_of(track(clip, false), clip);
  EXPECT_EQ(errors.circles, 12);
  EXPECT_EQ(errors.wrong, 0);
  EXPECT_LT(errors.radius.over_sds(), 1.4);
}

// Rims of this ball are 0.08 px too large, and stated to 0.12 px. What its turns tell takes half of
// it off, in every frame alike: they scatter as before.
TEST(LampTrack, ASpheresRadiusIsTheOneThatItsTurnsTell) {
  const LightScene scene{.name = "half", .sphere = true, .lamp_share = 0.5};
  const LightFilm clip(scene, 2, 12);
  const TrackResult result = track(clip, true, false), by_rims = track(clip, false, false);
  const LightErrors errors = errors_of(result, clip);
  EXPECT_EQ(errors.circles, 12);
  EXPECT_LT(errors.radius.rms(), 0.05);
  EXPECT_LT(errors.radius.over_sds(), 1.4);
  EXPECT_GT(errors_of(by_rims, clip).radius.rms(), 1.5 * errors.radius.rms());
  const double off_px = result.rows[0].r_px - by_rims.rows[0].r_px;
  for (std::size_t k = 0; k < result.rows.size(); ++k) {
    EXPECT_NEAR(result.rows[k].r_px - by_rims.rows[k].r_px, off_px, 1e-9) << k;
    EXPECT_LT(result.rows[k].r_sd_px, by_rims.rows[k].r_sd_px) << k;
  }
}

}  // namespace
}  // namespace impactdic::testing
