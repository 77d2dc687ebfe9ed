// Poses by keyframes: without drift, over gaps, and while the ball's look changes.
#include <gtest/gtest.h>

#include <set>

#include "tests/support/rendered_clip.h"
#include "tests/support/speckle_frames.h"

namespace impactdic::testing {
namespace {

std::vector<BallPose> path(int frames, double middle_px) {
  std::vector<BallPose> poses;
  for (int k = 0; k < frames; ++k) {
    poses.push_back(pose(middle_px + 8 * std::sin(0.07 * k), middle_px + 0.21 * k, 3.01 * k + 11));
  }
  return poses;
}

SynthScene noisy(int side) {
  SynthScene scene;
  scene.width = scene.height = side;
  scene.noise_sigma = 2;
  return scene;
}

TEST(Keyframes, PosesDoNotDrift) {
  RenderedClip clip(sim::speckle::paint_ball("e1", 3), noisy(280), path(36, 138));
  const DriftErrors got = drift(track(clip, Estimator::kBall), clip.poses());
  std::printf("rms %.5f %.5f px, %.5f deg\n", got.x.rms(), got.y.rms(), got.angle_deg.rms());
  EXPECT_EQ(got.lost, 0);
  EXPECT_LE(got.x.rms(), 0.001);
  EXPECT_LE(got.y.rms(), 0.001);
  EXPECT_LE(got.angle_deg.rms(), 0.001);
}

// Three frames without a ball, during which it turns by 12°.
TEST(Keyframes, AGapIsBridged) {
  const std::vector<BallPose> poses = path(24, 68);
  std::vector<Frame> frames = render_frames(quick_ball(2, 50), noisy(140), poses);
  for (std::size_t k = 10; k < 13; ++k) {
    std::fill_n(frames[k].u8.data(), frames[k].u8.size(), std::uint8_t{30});
  }
  MemoryClip clip(frames);
  const auto rows = track(clip, Estimator::kBall);
  for (std::size_t k = 10; k < 13; ++k) EXPECT_FALSE(rows[k].pose.ok) << k;
  for (std::size_t k = 13; k < rows.size(); ++k) {
    ASSERT_TRUE(rows[k].pose.ok) << k;
    EXPECT_EQ(rows[k].pose.origin, 0);
    EXPECT_NEAR(rows[k].pose.angle_rad * kDegPerRad, poses[k].angle_deg - poses[0].angle_deg, 0.02);
    EXPECT_NEAR(rows[k].pose.y_px, poses[k].cy_px, 0.05);
  }
}

// A part of the ink goes and other ink comes in every frame, as on a ball that rolls out of sight.
TEST(Keyframes, AChangingLookIsFollowedByNewKeyframes) {
  const std::vector<BallPose> poses = path(30, 68);
  sim::speckle::SpeckleBall ball = quick_ball(3, 50);
  const sim::speckle::SpeckleBall fresh = quick_ball(4, 50);
  std::vector<Frame> frames(poses.size());
  std::size_t next = 0;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    sim::speckle::BallRenderer(ball, noisy(140))
        .render(poses[k], static_cast<std::int64_t>(k), frames[k]);
    for (int n = 0; n < 4; ++n, ++next) {
      ball.discs[next % ball.discs.size()] = fresh.discs[next % fresh.discs.size()];
    }
  }
  MemoryClip clip(frames);
  const auto rows = track(clip, Estimator::kBall);
  std::set<std::int64_t> keyframes;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ASSERT_TRUE(rows[k].pose.ok) << k;
    EXPECT_EQ(rows[k].pose.origin, 0);
    EXPECT_NEAR(rows[k].pose.angle_rad * kDegPerRad, poses[k].angle_deg - poses[0].angle_deg, 0.1);
    keyframes.insert(rows[k].pose.keyframe);
  }
  EXPECT_GE(keyframes.size(), 3u);
  EXPECT_LE(keyframes.size(), 20u);
}

// A contact of 10 % compression in the middle of a flight.
TEST(Keyframes, PosesAfterAContactLeanOnThoseBeforeIt) {
  std::vector<BallPose> poses = path(30, 138);
  for (std::size_t k = 11; k < 18; ++k) {
    poses[k].compression = 0.1 * std::sin(kPi * (static_cast<double>(k) - 10) / 8);
    poses[k].compression_axis_deg = 90;
  }
  RenderedClip clip(sim::speckle::paint_ball("e1", 3), noisy(280), poses);
  const auto rows = track(clip, Estimator::kBall);
  for (std::size_t k = 18; k < rows.size(); ++k) {
    ASSERT_TRUE(rows[k].pose.ok) << k;
    EXPECT_TRUE(rows[k].pose.keyframe <= 11 || rows[k].pose.keyframe >= 17)
        << k << " leans on " << rows[k].pose.keyframe;
    const double off =
        rows[k].pose.angle_rad * kDegPerRad - (poses[k].angle_deg - poses[0].angle_deg);
    EXPECT_LT(std::abs(off), 0.005) << k;
    EXPECT_LT(std::abs(off), 6 * rows[k].pose.angle_sd_rad * kDegPerRad) << k;
  }
}

TEST(Keyframes, AnotherBallBeginsAnew) {
  const std::vector<BallPose> poses = path(20, 68);
  std::vector<Frame> frames = render_frames(quick_ball(5, 50), noisy(140), poses);
  const std::vector<Frame> others = render_frames(quick_ball(6, 50), noisy(140), poses);
  std::copy(others.begin() + 9, others.end(), frames.begin() + 9);
  MemoryClip clip(frames);
  const auto rows = track(clip, Estimator::kBall);
  EXPECT_FALSE(rows[8].motion_ok);
  EXPECT_EQ(rows[8].pose.origin, 0);
  for (std::size_t k = 9; k < rows.size(); ++k) {
    EXPECT_EQ(rows[k].pose.origin, 9) << k;
    EXPECT_NEAR(rows[k].pose.angle_rad * kDegPerRad, poses[k].angle_deg - poses[9].angle_deg, 0.02);
  }
}

}  // namespace
}  // namespace impactdic::testing
