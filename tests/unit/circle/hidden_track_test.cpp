// Tracks of balls of which something hides a part, and of one that turns far, by the same run as a
// clip's file.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <string>

#include "tests/support/tracks/light_tracks.h"

namespace impactdic::testing {
namespace {

constexpr int kFrames = 10;

// Of two balls, every frame of which is measured: as exact as may be, and as it says.
void expect_measured(const LightScene& scene, double centre_px, double shift_px) {
  LightErrors errors;
  for (const std::uint64_t seed : {2, 4}) {
    const LightFilm clip(scene, seed, kFrames);
    errors.add(errors_of(track(clip), clip));
  }
  EXPECT_EQ(errors.circles, 2 * kFrames);
  EXPECT_EQ(errors.motions, 2 * (kFrames - 1));
  EXPECT_EQ(errors.wrong, 0);
  EXPECT_LT(errors.centre.rms(), centre_px);
  EXPECT_LT(errors.shift.rms(), shift_px);
  for (const LightErrors::Axis* axis : {&errors.centre, &errors.shift, &errors.turn}) {
    EXPECT_LT(axis->over_sds(), 1.5);
  }
}

TEST(HiddenTrack, AnUprightBar) {
  expect_measured({.name = "upright", .radius_px = 60, .hidden = 0.3, .bar_angle_deg = 90}, 0.04,
                  0.0025);
}

// The bar hides less from frame to frame or more, and the ball is followed by what was learnt of it
// before.
TEST(HiddenTrack, ABallThatIsFollowedPastABar) {
  for (const double dx_px : {-3.0, 3.0}) {
    SCOPED_TRACE(dx_px);
    expect_measured({.name = "past",
                     .radius_px = 60,
                     .hidden = 0.2,
                     .bar_angle_deg = 90,
                     .dx_px = dx_px,
                     .dy_px = 0.3},
                    0.04, 0.0025);
  }
}

// As bright as the background: a part of the ball is simply not there. The motion tells it, and the
// rim beside it tells no radius: ten of the first ball's twelve circles were wrong by it.
TEST(HiddenTrack, ABarThatIsNotSeen) {
  const LightScene scene{.name = "not seen", .radius_px = 60, .hidden = 0.3, .bar_level = 30};
  LightErrors circles, motions;
  for (const std::uint64_t seed : {6, 20}) {
    const LightFilm clip(scene, seed, 12);
    circles.add(errors_of(track(clip, false), clip));
  }
  EXPECT_EQ(circles.circles, 24);
  EXPECT_EQ(circles.wrong, 0);
  EXPECT_LT(circles.radius.over_sds(), 3);
  for (const std::uint64_t seed : {1, 3}) {
    const LightFilm clip(scene, seed, kFrames);
    motions.add(errors_of(track(clip), clip));
  }
  EXPECT_EQ(motions.motions, 2 * (kFrames - 1));
  EXPECT_EQ(motions.wrong, 0);
  EXPECT_LT(motions.shift.rms(), 0.0025);
  EXPECT_LT(motions.shift.over_sds(), 1.5);
  EXPECT_LT(motions.turn.over_sds(), 1.5);
}

// Windows at the rim move by 26 px, farther than they are searched for by themselves; the ball is
// found at any turn.
TEST(HiddenTrack, TwentyFiveDegreesAFrame) {
  const LightScene scene{.name = "turns", .radius_px = 60, .rotation_deg = 25};
  const LightFilm clip(scene, 1, 6);
  const TrackResult result = track(clip);
  for (const std::string& warning : result.warnings) {
    EXPECT_EQ(warning.find("--search"), std::string::npos) << warning;
  }
  const LightErrors errors = errors_of(result, clip);
  EXPECT_EQ(errors.motions, 5);
  EXPECT_EQ(errors.wrong, 0);
  EXPECT_LT(errors.turn.rms(), 0.003);
  EXPECT_LT(errors.turn.over_sds(), 1.7);
  // The centre's error enters with twice the sine of half the turn.
  EXPECT_LT(errors.shift.rms(), 0.015);
  EXPECT_LT(errors.shift.over_sds(), 1.7);
  for (const TrackRow& row : result.rows) {
    if (row.motion_ok) {
      EXPECT_GT(row.windows, 30) << row.frame;
    }
  }
}

// Rings shrink to what a bar leaves of them, however little: those of the whole ball were off by
// 0.005 degrees, five deviations.
TEST(HiddenTrack, RingsBehindABar) {
  const LightFilm clip({.name = "ring", .hidden = 0.3}, 2, kFrames);
  const LightErrors errors = errors_of(track(clip, true, true, Estimator::kRing), clip);
  std::printf("turn %.4f deg, %.2f\n", errors.turn.rms(), errors.turn.over_sds());
  EXPECT_EQ(errors.motions, kFrames - 1);
  EXPECT_LT(errors.turn.rms(), 0.012);
  EXPECT_LT(errors.turn.over_sds(), 1.6);
}

}  // namespace
}  // namespace impactdic::testing
