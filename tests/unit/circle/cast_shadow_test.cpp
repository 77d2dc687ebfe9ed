// A ball before a wall on which its own shadow lies, as round and as large as the ball.
#include "host/circle/scene/cast_shadow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "host/circle/ball_tracker.h"
#include "host/circle/circle.h"
#include "host/circle/second_look/rim_beyond.h"
#include "sim/speckle/render.h"
#include "tests/support/tracks/light_tracks.h"

namespace impactdic::testing {
namespace {

constexpr double kWall = 90;   // grey levels more than the scene's background
constexpr double kLeft = 0.6;  // of its light in the shadow, which is then brighter than ink

struct Offset {
  double x_px, y_px;
};
constexpr Offset kOffsets[] = {{40, 25}, {15, 10}, {-30, -34}, {20, -8}};

struct Shown {
  Frame frame;
  Circle ball;
};

// A ball of 60 px before a wall that is bright but for its shadow, whose edge is soft.
Shown shown(const LightScene& scene, Offset shadow, double left, std::uint64_t seed = 3) {
  const double radius_px = scene.radius_px;
  LightClip clip(scene, seed, 1);
  Shown out;
  clip.render(0, out.frame);
  const BallPose& pose = clip.poses()[0];
  out.ball = {pose.cx_px, pose.cy_px, radius_px};
  for (int y = 0; y < out.frame.height(); ++y) {
    for (int x = 0; x < out.frame.width(); ++x) {
      const double off = std::hypot(x - pose.cx_px, y - pose.cy_px) - radius_px;
      const double in =
          radius_px - std::hypot(x - pose.cx_px - shadow.x_px, y - pose.cy_px - shadow.y_px);
      const double light = 1 - (1 - left) / (1 + std::exp(-in / 2));
      const double behind = std::clamp(off + 0.5, 0.0, 1.0);
      const double level = out.frame.u8(x, y);
      out.frame.u8(x, y) = static_cast<std::uint8_t>(
          std::lround(level + behind * ((level + kWall) * light - level)));
    }
  }
  return out;
}

// A disc.
Shown shown(const char* pattern, Offset shadow, double left) {
  return shown(LightScene{.name = "shadow", .pattern = pattern, .radius_px = 60}, shadow, left);
}

double off_px(const Circle& a, const Circle& b) {
  return std::hypot(a.cx_px - b.cx_px, a.cy_px - b.cy_px);
}

TEST(CastShadow, TellsWhatLiesBeforeIt) {
  for (const Offset& at : kOffsets) {
    const Shown s = shown("e1", at, kLeft);
    const Circle shadow{s.ball.cx_px + at.x_px, s.ball.cy_px + at.y_px, 60};
    const auto thing = circle::what_casts(s.frame, shadow);
    ASSERT_TRUE(thing) << at.x_px;
    EXPECT_LT(off_px(*thing, s.ball), 3) << at.x_px;
    EXPECT_NEAR(thing->r_px, 60, 3) << at.x_px;
  }
}

// Where nothing of the ball shows for a moment its shadow does.
TEST(CastShadow, IsNoBallThatIsFoundAgain) {
  constexpr Offset kAt = {70, 45};
  Shown s = shown("e1", kAt, 0.2);
  circle::BallTracker tracker;
  for (const int k : {0, 1}) {
    const circle::CircleFit fit = tracker.track(s.frame, k);
    ASSERT_EQ(fit.status, circle::CircleStatus::kOk);
    ASSERT_LT(off_px(fit.circle, s.ball), 1);
  }
  const Circle shadow{s.ball.cx_px + kAt.x_px, s.ball.cy_px + kAt.y_px, s.ball.r_px};
  const auto level = [&](double x, double y) { return s.frame.u8(int(x), int(y)); };
  const std::uint8_t wall = level(5, 5), dark = level(shadow.cx_px + 20, shadow.cy_px + 20);
  for (int y = 0; y < s.frame.height(); ++y) {
    for (int x = 0; x < s.frame.width(); ++x) {
      if (std::hypot(x - s.ball.cx_px, y - s.ball.cy_px) > s.ball.r_px + 1) continue;
      const bool in = std::hypot(x - shadow.cx_px, y - shadow.cy_px) < shadow.r_px;
      s.frame.u8(x, y) = in ? dark : wall;
    }
  }
  EXPECT_NE(tracker.track(s.frame, 2).status, circle::CircleStatus::kOk);
}

TEST(CastShadow, NoBallIsOne) {
  for (const char* pattern : {"a1", "a2", "b2", "c3", "d1", "d2", "e1", "e2", "f1"}) {
    const Shown s = shown(pattern, {300, 0}, 1);
    EXPECT_FALSE(circle::what_casts(s.frame, s.ball)) << pattern;
  }
}

// It was found for the ball, or a circle about both.
TEST(CastShadow, IsNotFoundForTheBall) {
  for (const char* pattern : {"a2", "d2", "e1", "f1"}) {
    for (const Offset& at : kOffsets) {
      const Shown s = shown(pattern, at, kLeft);
      const auto found = circle::find_ball(s.frame, {});
      ASSERT_TRUE(found) << pattern << at.x_px;
      EXPECT_LT(off_px(*found, s.ball), 2) << pattern << at.x_px;
      EXPECT_NEAR(found->r_px, 60, 2) << pattern << at.x_px;
    }
  }
}

// One so far from the ball that the ball hides little of it, or nothing, looks rounder than the
// ball.
TEST(CastShadow, BesideTheBallIsNotFoundForIt) {
  for (const char* pattern : {"a2", "d2", "e1", "e2", "f1"}) {
    for (const Offset& at : {Offset{80, 50}, Offset{-60, -75}, Offset{-20, 85}}) {
      const Shown s = shown(pattern, at, 0.4);
      const auto found = circle::find_ball(s.frame, {});
      ASSERT_TRUE(found) << pattern << at.x_px;
      EXPECT_LT(off_px(*found, s.ball), 2) << pattern << at.x_px;
      const Circle shadow{s.ball.cx_px + at.x_px, s.ball.cy_px + at.y_px, 60};
      EXPECT_TRUE(circle::is_flat_dark(s.frame, shadow, &s.ball)) << pattern << at.x_px;
      EXPECT_FALSE(circle::is_flat_dark(s.frame, s.ball, nullptr)) << pattern << at.x_px;
    }
  }
}

// A small one, all of whose shadow is in view, was followed all along a clip.
TEST(CastShadow, BesideASmallBallIsNotFoundForIt) {
  constexpr double kRadius = 30;
  SynthScene scene;
  scene.width = scene.height = 200;
  scene.noise_sigma = 2;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("f1", seed, kRadius), scene);
    const BallPose pose{110, 88, 0};
    Frame frame;
    renderer.render(pose, 0, frame);
    for (int y = 0; y < 200; ++y) {
      for (int x = 0; x < 200; ++x) {
        const double behind =
            std::clamp(std::hypot(x - pose.cx_px, y - pose.cy_px) - kRadius + 0.5, 0.0, 1.0);
        const double in = kRadius - std::hypot(x - pose.cx_px - 40, y - pose.cy_px - 25);
        const double wall = 150 * (1 - 0.6 / (1 + std::exp(-in / 2.5)));
        const double level = frame.u8(x, y);
        frame.u8(x, y) = static_cast<std::uint8_t>(std::lround(level + behind * (wall - level)));
      }
    }
    const auto found = circle::find_ball(frame, {});
    ASSERT_TRUE(found) << seed;
    EXPECT_LT(off_px(*found, {pose.cx_px, pose.cy_px, kRadius}), 2) << seed;
  }
}

// Of a lit sphere of large marks, too, the rim is plain where it lies beside its shadow.
TEST(CastShadow, LeavesTheBallsRimPlainBesideIt) {
  const LightScene scene{
      .name = "shadow", .sphere = true, .pattern = "d1", .radius_px = 60, .lamp_share = 0.2};
  const Offset at = kOffsets[0];
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
    const Shown s = shown(scene, at, 0.4, seed);
    const auto found = circle::find_ball(s.frame, {});
    ASSERT_TRUE(found) << seed;
    EXPECT_LT(off_px(*found, s.ball), 2) << seed;
    const Circle shadow{s.ball.cx_px + at.x_px, s.ball.cy_px + at.y_px, 60};
    EXPECT_TRUE(circle::shows_beside(s.frame, s.ball, shadow)) << seed;
    // The other way round, or where nothing lies, there is no rim.
    const Circle nothing{s.ball.cx_px - at.x_px, s.ball.cy_px - at.y_px, 60};
    EXPECT_FALSE(circle::shows_beside(s.frame, nothing, s.ball)) << seed;
  }
}

// A circle that fits was given up for what it left out.
TEST(CastShadow, IsNothingOfTheBallBeyondItsRim) {
  for (const Offset& at : {kOffsets[1], kOffsets[3]}) {
    const Shown s = shown("e1", at, kLeft);
    const circle::Rim rim{s.ball.cx_px, s.ball.cy_px, 60, 0, 0};
    EXPECT_EQ(beyond_rim(s.frame, rim, 0.7).share, 0) << at.x_px;
  }
}

}  // namespace
}  // namespace impactdic::testing
