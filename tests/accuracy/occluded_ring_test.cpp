// Rings about a ball of which a racket's frame hides a part (section 2.4.1).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "host/dic/frames/device_frames.h"
#include "host/motion/motion_estimator.h"
#include "tests/support/engine.h"
#include "tests/support/speckle_frames.h"

namespace impactdic {
namespace {

using testing::pose;

constexpr double kRadius = 100;

double free_of(const OccludingBar& bar, const Circle& circle) {
  const double angle = bar.angle_deg * kRadPerDeg;
  const double off =
      std::sin(angle) * (bar.x_px - circle.cx_px) + std::cos(angle) * (bar.y_px - circle.cy_px);
  return std::abs(off) - bar.width_px / 2;
}

struct Errors {
  double followed = 0, whole = 0;         // rms, degrees
  double least_px = 1e9, most_px = -1e9;  // of the free part, measured less true
};

constexpr int kPairs = 6;
constexpr double kTurnDeg = 4;

// First and second pose of every pair, by chance.
std::vector<BallPose> turning_poses() {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> off(-1, 1);
  std::vector<BallPose> poses;
  for (int k = 0; k < kPairs; ++k) {
    poses.push_back(pose(130 + off(random), 130 + off(random), 180 * off(random)));
    poses.push_back(pose(poses.back().cx_px + off(random), poses.back().cy_px + off(random),
                         poses.back().angle_deg + kTurnDeg));
  }
  return poses;
}

// Pairs of a ball that turns and sinks behind a bar, with the rings that follow the
// free part and with those of the whole ball.
Errors turns_behind_a_bar(double hidden, double bar_angle_deg) {
  SynthScene scene;
  scene.width = scene.height = 260;
  scene.noise_sigma = 1;
  scene.bar = sim::speckle::bar_hiding(hidden, pose(130, 130, 0), kRadius, bar_angle_deg);
  const std::vector<BallPose> poses = turning_poses();
  const auto pictures =
      testing::render_frames(sim::speckle::paint_ball("e1", 2, kRadius), scene, poses);
  dic::DeviceFrames frames(testing::shared_engine(), 2 * kPairs);
  Errors errors;
  std::vector<motion::PairMotion> followed(kPairs), whole;
  std::vector<Circle> circles;
  for (int k = 0; k < 2 * kPairs; ++k) {
    const auto at = static_cast<std::size_t>(k);
    frames.set(k, pictures[at]);
    circle::CirclePrior prior;
    prior.predicted = {130, 130, kRadius};
    prior.radius_px = kRadius;
    prior.radius_sd_px = 0.05;
    const circle::CircleFit fit = circle::measure_circle(pictures[at], prior, {});
    EXPECT_EQ(fit.status, circle::CircleStatus::kOk);
    const double off_by = fit.circle.free_px - free_of(*scene.bar, fit.circle);
    errors.least_px = std::min(errors.least_px, off_by);
    errors.most_px = std::max(errors.most_px, off_by);
    circles.push_back(fit.circle);
  }
  for (std::size_t k = 0; k < kPairs; ++k) {
    followed[k].first_slot = static_cast<int>(2 * k);
    followed[k].second_slot = static_cast<int>(2 * k + 1);
    // The true centres: what is compared is the rings alone.
    followed[k].first = {poses[2 * k].cx_px, poses[2 * k].cy_px, kRadius, circles[2 * k].free_px};
    followed[k].second = {poses[2 * k + 1].cx_px, poses[2 * k + 1].cy_px, kRadius,
                          circles[2 * k + 1].free_px};
  }
  whole = followed;
  for (motion::PairMotion& pair : whole) pair.first.free_px = pair.second.free_px = 0;
  motion::EstimatorOptions options;
  options.estimator = Estimator::kRing;
  const auto estimator =
      motion::make_motion_estimator(testing::shared_engine(), options, kRadius, frames);
  const auto rms = [&](std::vector<motion::PairMotion>& pairs) {
    estimator->measure(pairs);
    double squares = 0;
    for (const motion::PairMotion& pair : pairs) {
      const double error = pair.motion.rot_rad * kDegPerRad - kTurnDeg;
      squares += (pair.motion.ok ? error * error : kTurnDeg * kTurnDeg) / kPairs;
    }
    return std::sqrt(squares);
  };
  errors.followed = rms(followed);
  errors.whole = rms(whole);
  std::printf("%2.0f %% hidden: rms %.4f deg, %.4f with rings of the whole ball; ", 100 * hidden,
              errors.followed, errors.whole);
  std::printf("free part off by %.2f to %.2f px\n", errors.least_px, errors.most_px);
  return errors;
}

TEST(OccludedRing, FollowsTheVisiblePart) {
  for (const double hidden : {0.1, 0.2}) {
    const Errors errors = turns_behind_a_bar(hidden, 30);
    // Never into the bar by as much as the rings keep away from it; ink beside the bar makes the
    // gap in the rim look wider, and the free part smaller.
    EXPECT_LT(errors.most_px, 2);
    EXPECT_GT(errors.least_px, -12);
    EXPECT_LT(errors.followed, 0.005);
    EXPECT_LT(errors.followed, 0.5 * errors.whole);
  }
}

TEST(OccludedRing, NothingHiddenChangesNothing) {
  circle::CirclePrior prior;
  prior.predicted = {130, 130, kRadius};
  SynthScene scene;
  scene.width = scene.height = 260;
  for (const char* pattern : {"a1", "e1"}) {
    const auto pictures = testing::render_frames(sim::speckle::paint_ball(pattern, 2, kRadius),
                                                 scene, {pose(130.3, 129.8, 20)});
    const circle::CircleFit fit = circle::measure_circle(pictures[0], prior, {});
    ASSERT_EQ(fit.status, circle::CircleStatus::kOk);
    EXPECT_GT(fit.circle.free_px, 0.98 * fit.circle.r_px) << pattern;
  }
}

}  // namespace
}  // namespace impactdic
