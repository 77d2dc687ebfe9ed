// The circle over the frames of a clip. A real one: a steel ball before a lamp, 12 bits, with a
// glint inside it and a plate below. Rendered ones: what frames have in common.
#include <gtest/gtest.h>
#include <impactdic/units.h>

#include <cmath>
#include <vector>

#include "host/circle/ball_tracker.h"
#include "host/video/frame_source.h"
#include "sim/speckle/render.h"
#include "tests/support/data.h"

namespace impactdic {
namespace {

constexpr const char* kClip = "mraw/ball_12bit.cihx";

std::vector<circle::CircleFit> track_all(FrameSource& clip) {
  circle::BallTracker tracker;
  std::vector<circle::CircleFit> fits;
  Frame frame;
  for (std::int64_t i = 0; i < clip.info().frame_count; ++i) {
    clip.read(i, frame);
    fits.push_back(tracker.track(frame, i));
  }
  return fits;
}

// RMS about the least-squares quadratic, by orthogonal polynomials on equidistant points.
double rms_about_quadratic(std::vector<double> y) {
  const double n = static_cast<double>(y.size());
  const auto t = [&](std::size_t i) { return static_cast<double>(i) - (n - 1) / 2; };
  const std::vector<double (*)(double, double)> basis = {
      [](double, double) { return 1.0; }, [](double u, double) { return u; },
      [](double u, double m) { return u * u - (m * m - 1) / 12; }};
  for (const auto f : basis) {
    double fy = 0, ff = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      fy += f(t(i), n) * y[i];
      ff += f(t(i), n) * f(t(i), n);
    }
    for (std::size_t i = 0; i < y.size(); ++i) y[i] -= fy / ff * f(t(i), n);
  }
  double sum = 0;
  for (double v : y) sum += v * v;
  return std::sqrt(sum / n);
}

TEST(RealBall, FollowsAQuadraticInTime) {
  IMPACTDIC_NEED_DATA(kClip);
  const auto clip = video::open_video({testing::data_path(kClip).string()});
  const std::vector<circle::CircleFit> fits = track_all(*clip);
  ASSERT_EQ(fits.size(), 15u);
  std::vector<double> x, y;
  for (const circle::CircleFit& fit : fits) {
    ASSERT_EQ(fit.status, circle::CircleStatus::kOk);
    EXPECT_FALSE(fit.bright);
    EXPECT_FALSE(fit.ellipse);
    EXPECT_NEAR(fit.circle.r_px, 63.47, 0.15);
    EXPECT_GT(fit.rim_fraction, 0.9);
    x.push_back(fit.circle.cx_px);
    y.push_back(fit.circle.cy_px);
  }
  EXPECT_LE(rms_about_quadratic(x), 0.003);
  EXPECT_LE(rms_about_quadratic(y), 0.005);
  EXPECT_NEAR(std::hypot(x.back() - x.front(), y.back() - y.front()) / 14, 2.647, 0.005);
}

TEST(RealBall, EveryFrameAloneGivesTheSame) {
  IMPACTDIC_NEED_DATA(kClip);
  const auto clip = video::open_video({testing::data_path(kClip).string()});
  const std::vector<circle::CircleFit> fits = track_all(*clip);
  Frame frame;
  for (std::int64_t i = 0; i < clip->info().frame_count; i += 7) {
    clip->read(i, frame);
    const auto found = circle::find_ball(frame, {});
    ASSERT_TRUE(found);
    const circle::CircleFit alone = circle::measure_circle(frame, {.predicted = *found}, {});
    EXPECT_NEAR(alone.circle.cx_px, fits[i].circle.cx_px, 0.005);
    EXPECT_NEAR(alone.circle.cy_px, fits[i].circle.cy_px, 0.005);
  }
}

SynthScene noisy_scene(int side) {
  SynthScene scene;
  scene.width = scene.height = side;
  scene.noise_sigma = 2;
  return scene;
}

// The last frame lies as the first ones predict, so those between are followed from both: a circle
// of the known radius fits what is left of a pressed ball's rim to a hundredth of a pixel.
// Of a ball that falls by 2 px more in sixteen frames than in those before: a line between two
// measured frames is a quarter of a pixel off.
TEST(BallTracker, ExpectsFramesWhereAForceBendsTheWay) {
  SynthScene scene;
  scene.width = 180, scene.height = 220;
  scene.noise_sigma = 2;
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("c2", 7, 50), scene);
  std::vector<Frame> frames(80);
  std::vector<BallPose> poses;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const auto t = static_cast<double>(k);
    poses.push_back({70 + 0.3 * t, 80 + 0.1 * t + 0.5 * 0.008 * t * t, 0.5 * t});
    renderer.render(poses.back(), static_cast<std::int64_t>(k), frames[k]);
  }
  circle::BallTracker tracker;
  std::vector<circle::CircleFit> fits(frames.size());
  const circle::BallTracker::Plan plan = tracker.lead(frames, 0, fits);
  const std::vector<circle::CirclePrior> expected = tracker.expected(plan);
  ASSERT_EQ(expected.size(), plan.left.size());
  int late = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::size_t frame = plan.left[i].frame;
    if (frame < 48) continue;  // once three frames sixteen apart are known
    ++late;
    EXPECT_NEAR(expected[i].predicted.cx_px, poses[frame].cx_px, 0.06) << frame;
    EXPECT_NEAR(expected[i].predicted.cy_px, poses[frame].cy_px, 0.06) << frame;
    EXPECT_LT(expected[i].centre_sd_px, 0.1) << frame;
  }
  EXPECT_EQ(late, 30);
}

TEST(BallTracker, SeesAContactBetweenRoundFrames) {
  constexpr int kFrames = 13;
  constexpr double kPressed = 60;
  const SynthScene scene = noisy_scene(180);
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("e1", 14, kPressed), scene);
  std::vector<Frame> frames(kFrames);
  std::vector<BallPose> poses;
  for (int k = 0; k < kFrames; ++k) {
    const double pressed = k > 4 && k < 8 ? 0.1 * std::sin(kPi * (k - 4) / 4) : 0;
    poses.push_back({85.3 + 0.73 * k, 92.1 - 0.41 * k, 68 + 1.1 * k, pressed, 90});
    renderer.render(poses.back(), k, frames[static_cast<std::size_t>(k)]);
  }
  std::vector<circle::CircleFit> fits(kFrames);
  circle::BallTracker().follow(frames, 0, fits);
  for (std::size_t k = 0; k < fits.size(); ++k) {
    ASSERT_EQ(fits[k].status, circle::CircleStatus::kOk) << k;
    EXPECT_NEAR(fits[k].circle.cx_px, poses[k].cx_px, 0.08) << k;
    EXPECT_NEAR(fits[k].circle.cy_px, poses[k].cy_px, 0.08) << k;
    EXPECT_NEAR(fits[k].circle.r_px, kPressed * (1 - poses[k].compression / 2), 0.1) << k;
    EXPECT_EQ(fits[k].ellipse, poses[k].compression > 0) << k;
  }
}

// In a contact the ball lies pixels off its prediction. Crossings once settled on a third of their
// points there, or were still on their way: 6 px off, with deviations of 0.35 px.
TEST(MeasureCircle, ACompressedBallFarFromItsPredictionIsNotWrong) {
  SynthScene scene;
  scene.width = scene.height = 280;
  const BallPose pose{156.0438, 156.7451, 0.551, 0.08586, 120};
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("e1", 1, 75), scene);
  Frame frame;
  renderer.render(pose, 0, frame);
  int lost = 0;
  for (int k = 0; k < 25; ++k) {
    const double x = 2.0 * (k % 5) - 4, y = 2.0 * (k / 5) - 4;
    circle::CirclePrior prior{.predicted = {pose.cx_px + x, pose.cy_px + y, 73.86}};
    prior.centre_sd_px = 0.34;
    prior.e1_px = 0.58;
    prior.e2_px = -0.96;
    prior.rim_sd_px = 0.37;
    prior.bright = prior.inked = true;
    prior.learn = false;
    prior.radius_px = 75;
    prior.radius_sd_px = 0.015;
    const circle::CircleFit fit = circle::measure_circle(frame, prior, {});
    if (fit.status != circle::CircleStatus::kOk) {
      ++lost;
      continue;
    }
    EXPECT_LT(std::abs(fit.circle.cx_px - pose.cx_px), 5 * fit.cx_sd_px) << x << ' ' << y;
    EXPECT_LT(std::abs(fit.circle.cy_px - pose.cy_px), 5 * fit.cy_sd_px) << x << ' ' << y;
  }
  EXPECT_LT(lost, 8);
}

// Frames that show the same ink agree on a radius that is wrong in all of them alike.
TEST(BallTracker, AgreementOfFramesIsNoExactness) {
  constexpr int kFrames = 12, kBalls = 8;
  constexpr double kSmall = 30;
  const SynthScene scene = noisy_scene(110);
  double squares = 0, first_sds = 0, last_sds = 0;
  for (std::uint64_t seed = 21; seed < 21 + kBalls; ++seed) {
    const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("e1", seed, kSmall), scene);
    std::vector<Frame> frames(kFrames);
    for (int k = 0; k < kFrames; ++k) {
      renderer.render(BallPose{50.3 + 0.73 * k, 57.1 - 0.41 * k, 1.1 * k}, k,
                      frames[static_cast<std::size_t>(k)]);
    }
    std::vector<circle::CircleFit> fits(kFrames);
    circle::BallTracker().follow(frames, 0, fits);
    for (const circle::CircleFit& fit : fits) {
      ASSERT_EQ(fit.status, circle::CircleStatus::kOk);
      const double off = (fit.circle.r_px - kSmall) / fit.r_sd_px;
      EXPECT_LT(std::abs(off), 5);
      squares += off * off;
    }
    first_sds += fits[1].r_sd_px;
    last_sds += fits[kFrames - 1].r_sd_px;
  }
  std::printf("%.2f; %.4f %.4f\n", std::sqrt(squares / (kFrames * kBalls)), first_sds / kBalls,
              last_sds / kBalls);
  EXPECT_LT(std::sqrt(squares / (kFrames * kBalls)), 2.2);
  EXPECT_GT(last_sds, 0.6 * first_sds);
}

// A ball is not seen where it bounces: its way leads out of the picture, and it is still there.
TEST(BallThatWasLost, IsFoundAfterABounceThatNoFrameShows) {
  constexpr double kRadiusPx = 30;
  SynthScene scene;
  scene.width = 160;
  scene.height = 220;
  scene.noise_sigma = 2;
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("c1", 3, kRadiusPx), scene);
  circle::BallTracker tracker;
  Frame frame;
  for (int k = 0; k < 9; ++k) {
    // Down at 25 px a frame, up again at 8; blurred beyond sight in frames 4 and 5.
    const double y = k < 4 ? 106 + 25.0 * k : 181 - 8.0 * (k - 5);
    const bool hidden = k == 4 || k == 5;
    renderer.render(BallPose{hidden ? -500.0 : 80.3, y}, k, frame);
    const circle::CircleFit fit = tracker.track(frame, k);
    if (hidden) {
      EXPECT_NE(fit.status, circle::CircleStatus::kOk) << k;
    } else {
      ASSERT_EQ(fit.status, circle::CircleStatus::kOk) << k;
      EXPECT_NEAR(fit.circle.cy_px, y, 0.1) << k;
    }
  }
}

}  // namespace
}  // namespace impactdic
