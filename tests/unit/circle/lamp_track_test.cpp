// Tracks of balls in the light of a lamp, by the same run as a clip's file.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace impactdic::testing
