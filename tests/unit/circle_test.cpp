// Finding, measuring and tracking the ball on rendered pictures: the situations. How exact the
// measurement is stands in tests/accuracy/circle_accuracy_test.cpp.
#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <impactdic/units.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <vector>

#include "host/circle/ball_tracker.h"
#include "sim/speckle/render.h"

namespace impactdic {
namespace {

constexpr double kRadius = 60;

SynthScene small_scene() {
  SynthScene scene;
  scene.width = 240;
  scene.height = 220;
  scene.noise_sigma = 2;
  return scene;
}

Frame picture(const sim::speckle::SpeckleBall& ball, const SynthScene& scene,
              const BallPose& pose) {
  Frame frame;
  sim::speckle::BallRenderer(ball, scene).render(pose, 0, frame);
  return frame;
}

double miss(const Circle& circle, const BallPose& pose) {
  return std::hypot(circle.cx_px - pose.cx_px, circle.cy_px - pose.cy_px);
}

TEST(FindBall, SpeckledBallOnADarkGround) {
  const BallPose pose{118.3, 101.8};
  for (const char* pattern : {"a1", "c3", "d3", "e1"}) {
    const Frame frame = picture(sim::speckle::paint_ball(pattern, 3, kRadius), small_scene(), pose);
    const auto found = circle::find_ball(frame, {});
    ASSERT_TRUE(found) << pattern;
    EXPECT_LT(miss(*found, pose), 1) << pattern;
    EXPECT_NEAR(found->r_px, kRadius, 1) << pattern;
  }
}

// The transform proposes eight circles about one ball. They are tried by their rim until one proves
// the ball; the others, and those that touch its rim, would only lead to it again. How many it
// takes is chance: 31 of 16 balls, 48 with those that touch it.
TEST(FindBall, ABallThatIsProvedIsNotTriedAgain) {
  int all = 0, balls = 0;
  for (const char* pattern : {"a1", "c3", "d3", "e1"}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed, ++balls) {
      const Frame frame =
          picture(sim::speckle::paint_ball(pattern, seed, kRadius), small_scene(), {118.3, 101.8});
      int proofs = 0;
      EXPECT_EQ(circle::find_balls(frame, {}, nullptr, false, &proofs).size(), 1u) << pattern;
      all += proofs;
    }
  }
  EXPECT_LE(all, 2 * balls);
}

TEST(FindBall, DarkBallBeforeALampBesideAPlate) {
  SynthScene scene = small_scene();
  scene.white = 45;
  scene.ink = 70;
  scene.background = 220;
  scene.bar = OccludingBar{120, 205, 0, 40, 100};  // a plate just below, that the ball nears
  const BallPose pose{97.4, 118.7};
  const Frame frame = picture(sim::speckle::paint_ball("b1", 3, kRadius), scene, pose);
  const auto found = circle::find_ball(frame, {});
  ASSERT_TRUE(found);
  EXPECT_LT(miss(*found, pose), 1);
  const circle::CircleFit fit = circle::measure_circle(frame, {.predicted = *found}, {});
  ASSERT_EQ(fit.status, circle::CircleStatus::kOk);
  EXPECT_FALSE(fit.bright);
  EXPECT_LT(miss(fit.circle, pose), 0.02);
}

TEST(FindBall, LeavesABarOrAnEmptyPictureAlone) {
  SynthScene scene = small_scene();
  const BallPose far_away{-500, -500};
  EXPECT_FALSE(circle::find_ball(picture({kRadius, {}, {}}, scene, far_away), {}));
  scene.bar = OccludingBar{120, 110, 20, 50, 190};
  EXPECT_FALSE(circle::find_ball(picture({kRadius, {}, {}}, scene, far_away), {}));
}

TEST(FindBall, KeepsToTheRadiusRange) {
  const BallPose pose{118.3, 101.8};
  const Frame frame = picture(sim::speckle::paint_ball("c1", 3, kRadius), small_scene(), pose);
  EXPECT_FALSE(circle::find_ball(frame, {.radius_range_px = {{20, 45}}}));
  EXPECT_TRUE(circle::find_ball(frame, {.radius_range_px = {{50, 70}}}));
}

TEST(MeasureCircle, WorksAtTwelveBits) {
  SynthScene scene = small_scene();
  scene.bits = 12;
  const BallPose pose{118.3, 101.8};
  const Frame frame = picture(sim::speckle::paint_ball("c1", 3, kRadius), scene, pose);
  const circle::CircleFit fit = circle::measure_circle(frame, {.predicted = {119.5, 101, 61}}, {});
  ASSERT_EQ(fit.status, circle::CircleStatus::kOk);
  EXPECT_LT(miss(fit.circle, pose), 0.01);
  EXPECT_NEAR(fit.circle.r_px, kRadius, 0.01);
}

TEST(MeasureCircle, RimPartlyOutsideThePicture) {
  const sim::speckle::SpeckleBall ball = sim::speckle::paint_ball("c1", 3, kRadius);
  for (const double x : {20.0, 8.0}) {
    const BallPose pose{x + 0.37, 104.2};
    const Frame frame = picture(ball, small_scene(), pose);
    const circle::CircleFit fit = circle::measure_circle(frame, {.predicted = {x, 105, 60.4}}, {});
    ASSERT_EQ(fit.status, circle::CircleStatus::kOk) << x;
    EXPECT_LT(fit.rim_fraction, 0.75) << x;
    EXPECT_LT(std::abs(fit.circle.cx_px - pose.cx_px), std::max(0.02, 4 * fit.cx_sd_px)) << x;
    EXPECT_LT(std::abs(fit.circle.cy_px - pose.cy_px), std::max(0.02, 4 * fit.cy_sd_px)) << x;
  }
}

TEST(MeasureCircle, OutOfView) {
  const BallPose pose{-25, 104.2};
  const Frame frame = picture(sim::speckle::paint_ball("c1", 3, kRadius), small_scene(), pose);
  const circle::CircleFit fit = circle::measure_circle(frame, {.predicted = {-25, 104, 60}}, {});
  EXPECT_EQ(fit.status, circle::CircleStatus::kOutOfView);
}

TEST(MeasureCircle, NoBall) {
  const Frame frame = picture({kRadius, {}, {}}, small_scene(), {-500, -500});
  EXPECT_EQ(circle::measure_circle(frame, {.predicted = {118, 101, 60}}, {}).status,
            circle::CircleStatus::kNoBall);
}

TEST(MeasureCircle, EllipseOnlyWhereTheBallDemandsIt) {
  const sim::speckle::SpeckleBall ball = sim::speckle::paint_ball("c1", 3, kRadius);
  const circle::CirclePrior prior{.predicted = {118, 102, 60}};
  EXPECT_FALSE(
      circle::measure_circle(picture(ball, small_scene(), {118.3, 101.8}), prior, {}).ellipse);
  // 5 % shorter along 30° (screen), that is −30° in image axes: long axis at 60°.
  const BallPose squashed{118.3, 101.8, 0, 0.05, 30};
  const Frame frame = picture(ball, small_scene(), squashed);
  const circle::CircleFit fit = circle::measure_circle(frame, prior, {});
  ASSERT_TRUE(fit.ellipse);
  EXPECT_NEAR(fit.circle.r_px, kRadius * 0.975, 0.02);
  EXPECT_NEAR(std::hypot(fit.e1_px, fit.e2_px), kRadius * 0.025, 0.02);
  EXPECT_NEAR(0.5 * std::atan2(fit.e2_px, fit.e1_px) * kDegPerRad, 60, 0.5);
  EXPECT_FALSE(circle::measure_circle(frame, prior, {.allow_ellipse = false}).ellipse);
}

TEST(MeasureCircle, TheSameOnEveryCall) {
  const Frame frame =
      picture(sim::speckle::paint_ball("e1", 3, kRadius), small_scene(), {118.3, 101.8});
  const circle::CirclePrior prior{.predicted = {119, 101, 60}};
  const circle::CircleFit first = circle::measure_circle(frame, prior, {});
  const Frame other =
      picture(sim::speckle::paint_ball("c1", 4, kRadius), small_scene(), {110, 105});
  circle::measure_circle(other, {.predicted = {110, 105, 60}}, {});  // leaves its memory behind
  const circle::CircleFit second = circle::measure_circle(frame, prior, {});
  EXPECT_EQ(first.circle.cx_px, second.circle.cx_px);
  EXPECT_EQ(first.circle.cy_px, second.circle.cy_px);
  EXPECT_EQ(first.cx_sd_px, second.cx_sd_px);
}

TEST(MeasureCircle, FollowsByTheRimModelOfTheFrameBefore) {
  const sim::speckle::SpeckleBall ball = sim::speckle::paint_ball("b1", 3, kRadius);
  const BallPose first{118.3, 101.8}, second{119.1, 103.2, 20};
  const circle::CircleFit before = circle::measure_circle(picture(ball, small_scene(), first),
                                                          {.predicted = {119, 101, 60}}, {});
  ASSERT_TRUE(before.rim_model);
  circle::CirclePrior prior;
  prior.predicted = {119.3, 103.0, before.circle.r_px};
  prior.centre_sd_px = 0.3;
  prior.rim_sd_px = 0.3;
  prior.bright = before.bright;
  prior.rim_model = before.rim_model;
  const circle::CircleFit fit =
      circle::measure_circle(picture(ball, small_scene(), second), prior, {});
  ASSERT_EQ(fit.status, circle::CircleStatus::kOk);
  EXPECT_EQ(fit.rim_model, before.rim_model);
  EXPECT_LT(miss(fit.circle, second), 0.02);
  // Where the ball is elsewhere, it is searched and its rim model learnt anew.
  const circle::CircleFit far =
      circle::measure_circle(picture(ball, small_scene(), {122.9, 106.5}), prior, {});
  EXPECT_NE(far.rim_model, before.rim_model);
}

// Little ink and little noise: a third of a pixel off, bare paint looks like anything but that.
TEST(MeasureCircle, FollowsSparseInkFromAThirdOfAPixel) {
  for (const char* pattern : {"c1", "d1"}) {
    const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball(pattern, 5, kRadius),
                                              small_scene());
    Frame frame;
    circle::CirclePrior prior;
    for (int k = 0; k < 24; ++k) {
      const BallPose pose{118.1 + 0.23 * k, 101.9 - 0.31 * k, 15.0 * k};
      renderer.render(pose, k, frame);
      const double way = 2.4 * k;
      prior.predicted = {pose.cx_px + 0.35 * std::cos(way), pose.cy_px + 0.35 * std::sin(way),
                         kRadius + 0.1};
      const circle::CircleFit fit = circle::measure_circle(frame, prior, {});
      ASSERT_EQ(fit.status, circle::CircleStatus::kOk);
      ASSERT_TRUE(fit.rim_model);
      EXPECT_LT(miss(fit.circle, pose), 0.02) << pattern << k;
      if (k == 0) {
        prior.centre_sd_px = prior.rim_sd_px.emplace(0.3);
        prior.bright = fit.bright;
        prior.rim_model = fit.rim_model;
      } else {
        EXPECT_EQ(fit.rim_model, prior.rim_model) << pattern << k;
      }
    }
  }
}

// A little compressed, whether that was expected or not: a circle across an ellipse explains its
// ends as ink.
TEST(MeasureCircle, FollowsABallThatIsPressed) {
  for (const char* pattern : {"a1", "d3", "e1"}) {
    const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball(pattern, 11, kRadius),
                                              small_scene());
    Frame frame;
    renderer.render(BallPose{118.3, 101.8}, 0, frame);
    const circle::CircleFit before =
        circle::measure_circle(frame, {.predicted = {119, 101, kRadius}}, {});
    ASSERT_TRUE(before.rim_model);
    circle::CirclePrior prior;
    prior.rim_sd_px = 0.3;
    prior.bright = before.bright;
    prior.rim_model = before.rim_model;
    for (int k = 1; k < 9; ++k) {
      const double compression = 0.002 * k, e = kRadius * compression / 2;
      const BallPose pose{118.3 + 0.37 * k, 101.8 - 0.21 * k, 15.0 * k, compression, 90};
      renderer.render(pose, k, frame);
      for (const bool expected : {true, false}) {
        prior.centre_sd_px = expected ? 0.05 : 0.3;
        prior.predicted = {pose.cx_px + 0.02, pose.cy_px - 0.03, kRadius - e};
        prior.e1_px = expected ? e : 0;
        const circle::CircleFit fit = circle::measure_circle(frame, prior, {});
        ASSERT_EQ(fit.status, circle::CircleStatus::kOk);
        EXPECT_LT(miss(fit.circle, pose), 0.06) << pattern << k << expected;
        EXPECT_NEAR(fit.circle.r_px, kRadius - e, 0.1) << pattern << k << expected;
        EXPECT_LT(std::hypot(fit.e1_px - e, fit.e2_px), 0.1) << pattern << k << expected;
        if (expected) {
          EXPECT_EQ(fit.rim_model, before.rim_model) << pattern << k;
        }
      }
    }
  }
}

// Half a pixel of ellipse that nothing foretold, on dense ink.
TEST(MeasureCircle, TakesNoEllipseForAnInkedCircle) {
  constexpr double kLarge = 115, kCompression = 0.008, kE = kLarge * kCompression / 2;
  SynthScene scene;
  scene.width = scene.height = 272;
  scene.noise_sigma = 2;
  for (const int seed : {11, 14}) {
    scene.noise_seed = static_cast<std::uint64_t>(seed) + 1;
    const sim::speckle::BallRenderer renderer(
        sim::speckle::paint_ball("e1", static_cast<std::uint64_t>(seed), kLarge), scene);
    const auto pose_at = [&](int k) {
      return BallPose{136 + std::fmod(0.3819660113 * seed + 0.13 + 0.618 * k, 1),
                      136 + std::fmod(0.6180339887 * seed + 0.41 + 0.382 * k, 1),
                      17.0 * seed + 11 * k, k == 0 ? 0 : kCompression, 90};
    };
    Frame frame;
    renderer.render(pose_at(0), 0, frame);
    circle::CirclePrior prior;
    prior.predicted = {pose_at(0).cx_px + 1.3, pose_at(0).cy_px - 0.9, kLarge};
    const circle::CircleFit before = circle::measure_circle(frame, prior, {});
    prior.bright = before.bright;
    prior.rim_model = before.rim_model;
    prior.centre_sd_px = prior.rim_sd_px.emplace(0.3);
    prior.learn = false;
    prior.radius_px = before.circle.r_px;
    prior.radius_sd_px = 0.03;
    prior.compression_axis_rad = kPi / 2;
    for (int k = 1; k < 8; ++k) {
      const BallPose pose = pose_at(k);
      renderer.render(pose, k, frame);
      const double way = 2.4 * (k + 8 * seed);
      prior.predicted = {pose.cx_px + 0.1 * std::cos(way), pose.cy_px + 0.1 * std::sin(way),
                         before.circle.r_px - kE + 0.03 * std::cos(1.7 * way)};
      const circle::CircleFit fit = circle::measure_circle(frame, prior, {});
      ASSERT_EQ(fit.status, circle::CircleStatus::kOk);
      EXPECT_LT(std::hypot(fit.e1_px - kE, fit.e2_px), 0.1) << seed << ' ' << k;
      EXPECT_NEAR(fit.circle.r_px, kLarge - kE, 0.15) << seed << ' ' << k;
    }
  }
}

TEST(MeasureCircle, RefusesNonsense) {
  const Frame frame = picture({kRadius, {}, {}}, small_scene(), {118, 102});
  EXPECT_THROW(circle::measure_circle(frame, {}, {}), InvalidArgument);
  EXPECT_THROW(circle::measure_circle(frame, {.predicted = {118, 102, 60}}, {.rays = 3}),
               InvalidArgument);
  EXPECT_THROW(circle::find_ball(frame, {.radius_range_px = {{50, 40}}}), InvalidArgument);
}

TEST(BallTracker, FollowsABounceAndFindsTheBallAgain) {
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("c1", 3, 40), small_scene());
  circle::BallTracker tracker;
  Frame frame;
  for (int k = 0; k < 24; ++k) {
    // Down at 7 px a frame, up again at 5; out of sight in frames 15 … 17.
    const double y = k < 10 ? 70 + 7.0 * k : 140 - 5.0 * (k - 10);
    const bool hidden = k >= 15 && k < 18;
    const BallPose pose{hidden ? -500 : 100.2 + 1.1 * k, y};
    renderer.render(pose, k, frame);
    const circle::CircleFit fit = tracker.track(frame, k);
    if (hidden) {
      EXPECT_EQ(fit.status, circle::CircleStatus::kNoBall) << k;
    } else {
      ASSERT_EQ(fit.status, circle::CircleStatus::kOk) << k;
      EXPECT_LT(miss(fit.circle, pose), 0.02) << k;
    }
  }
  ASSERT_TRUE(tracker.radius_px());
  EXPECT_NEAR(*tracker.radius_px(), 40, 0.01);
}

// In batches and in parallel: what one frame after the other gives, on any number of threads.
TEST(BallTracker, FollowsManyFramesAtOnce) {
  constexpr int kFrames = 100, kBatch = 24;
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("c1", 3, 40), small_scene());
  std::vector<Frame> frames(kFrames);
  std::vector<BallPose> poses;
  const auto hidden = [](int k) { return k < 5 || (k >= 60 && k < 75); };
  for (int k = 0; k < kFrames; ++k) {
    // Down at 2 px a frame, up again at 1.
    const double y = k < 37 ? 70 + 2.0 * k : 144 - 1.0 * (k - 37);
    poses.push_back({hidden(k) ? -500 : 100.2 + 0.3 * k, y});
    renderer.render(poses.back(), k, frames[static_cast<std::size_t>(k)]);
  }
  const auto follow = [&](int threads) {
    std::vector<circle::CircleFit> fits(kFrames);
    tbb::task_arena(threads).execute([&] {
      circle::BallTracker tracker;
      for (std::size_t first = 0; first < kFrames; first += kBatch) {
        const std::size_t count = std::min<std::size_t>(kBatch, kFrames - first);
        tracker.follow(std::span(frames).subspan(first, count), static_cast<std::int64_t>(first),
                       std::span(fits).subspan(first, count));
      }
    });
    return fits;
  };
  const auto fits = follow(1), again = follow(2);
  double squares = 0;
  int seen = 0;
  circle::BallTracker tracker;
  for (int k = 0; k < kFrames; ++k) {
    const circle::CircleFit &fit = fits[static_cast<std::size_t>(k)],
                            &same = again[static_cast<std::size_t>(k)];
    const circle::CircleFit one = tracker.track(frames[static_cast<std::size_t>(k)], k);
    EXPECT_EQ(fit.status, same.status);
    EXPECT_EQ(fit.circle.cx_px, same.circle.cx_px);
    EXPECT_EQ(fit.circle.cy_px, same.circle.cy_px);
    EXPECT_EQ(fit.circle.r_px, same.circle.r_px);
    EXPECT_EQ(fit.cx_sd_px, same.cx_sd_px);
    ASSERT_EQ(fit.status, hidden(k) ? circle::CircleStatus::kNoBall : circle::CircleStatus::kOk)
        << k;
    ASSERT_EQ(fit.status, one.status) << k;
    if (hidden(k)) continue;
    EXPECT_LT(miss(fit.circle, poses[static_cast<std::size_t>(k)]), 0.02) << k;
    squares += std::pow((fit.circle.cx_px - one.circle.cx_px) / fit.cx_sd_px, 2);
    ++seen;
  }
  // Another prediction turns the rays' phases, no more.
  EXPECT_LT(std::sqrt(squares / seen), 0.4);
}

TEST(BallTracker, SaysWhenTheBallLeaves) {
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("c1", 3, 40), small_scene());
  circle::BallTracker tracker;
  Frame frame;
  std::vector<circle::CircleStatus> statuses;
  for (int k = 0; k < 12; ++k) {
    const BallPose pose{90.4 - 11.0 * k, 110};
    renderer.render(pose, k, frame);
    const circle::CircleFit fit = tracker.track(frame, k);
    statuses.push_back(fit.status);
    if (pose.cx_px > 0) {
      ASSERT_EQ(fit.status, circle::CircleStatus::kOk) << k;
      EXPECT_LT(miss(fit.circle, pose), std::max(0.02, 5 * fit.cx_sd_px)) << k;
    } else if (pose.cx_px > -40) {
      EXPECT_NE(fit.status, circle::CircleStatus::kOk) << k;
    }
  }
  EXPECT_EQ(statuses[9], circle::CircleStatus::kOutOfView);
}

}  // namespace
}  // namespace impactdic
