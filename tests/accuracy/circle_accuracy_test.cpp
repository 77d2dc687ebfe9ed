// How exactly the ball's circle is measured: rendered balls of radius 115 px, noise 2, patterns a1
// (sparse) and e1 (dense), places incommensurate with the pixels, seeds 100, 101, … (not chosen).
#include <gtest/gtest.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/circle/circle.h"
#include "sim/speckle/render.h"

namespace impactdic {
namespace {

constexpr double kRadius = 115;
constexpr int kBalls = 12;

struct Condition {
  bool bar = false;
  double compression = 0;  // along the screen's vertical
  double shading = 0;
  bool radius_known = false;  // from earlier frames of the clip
  double blur_px = 0.6;
  bool cut_close = false;  // the picture ends 20 px beyond the ball
};

struct Errors {
  double rms_px = 0;  // per axis
  double radius_rms_px = 0;
  double normalised = 0;  // mean square of error over its stated deviation
  double radius_normalised = 0;
};

// The lower 30 % of the rim hidden: a bar whose upper edge cuts the rim at ±54° from straight down.
OccludingBar bar_over_rim(const BallPose& pose) {
  OccludingBar bar;
  bar.width_px = 2.5 * kRadius;
  bar.x_px = pose.cx_px;
  bar.y_px = pose.cy_px + kRadius * std::cos(0.3 * kPi) + bar.width_px / 2;
  return bar;
}

// Painting takes longer than all the rest.
const sim::speckle::SpeckleBall& painted(const std::string& pattern, int seed) {
  static std::map<std::pair<std::string, int>, sim::speckle::SpeckleBall> balls;
  const auto [at, is_new] = balls.try_emplace({pattern, seed});
  if (is_new)
    at->second = sim::speckle::paint_ball(pattern, static_cast<std::uint64_t>(seed), kRadius);
  return at->second;
}

Errors measure_balls(const std::string& pattern, const Condition& condition, int balls = kBalls) {
  double squares = 0, radius_squares = 0, normalised = 0, radius_normalised = 0;
  for (int k = 0; k < balls; ++k) {
    const double x = condition.cut_close ? 136 : 250, y = condition.cut_close ? 136 : 260;
    const BallPose pose{x + std::fmod(0.3819660113 * k + 0.13, 1),
                        y + std::fmod(0.6180339887 * k + 0.41, 1), 17.0 * k, condition.compression,
                        90};
    SynthScene scene;
    if (condition.cut_close) scene.width = scene.height = 272;
    scene.noise_sigma = 2;
    scene.noise_seed = static_cast<std::uint64_t>(k) + 1;
    scene.shading = condition.shading;
    scene.psf_sigma_px = condition.blur_px;
    if (condition.bar) scene.bar = bar_over_rim(pose);
    Frame frame;
    sim::speckle::BallRenderer(painted(pattern, 100 + k), scene).render(pose, k, frame);
    // As after a Hough transform: a pixel or two away, the shape unknown.
    circle::CirclePrior prior;
    prior.predicted = {pose.cx_px + 1.3, pose.cy_px - 0.9, kRadius + 0.4};
    if (condition.radius_known) {
      prior.radius_px = kRadius;
      prior.radius_sd_px = 0.01;
      prior.compression_axis_rad = kPi / 2;
    }
    const circle::CircleFit fit = circle::measure_circle(frame, prior, {});
    EXPECT_EQ(fit.status, circle::CircleStatus::kOk) << pattern << " " << k;
    const double ex = fit.circle.cx_px - pose.cx_px, ey = fit.circle.cy_px - pose.cy_px;
    const double er = fit.circle.r_px - kRadius * (1 - condition.compression / 2);
    squares += (ex * ex + ey * ey) / 2;
    radius_squares += er * er;
    radius_normalised += std::pow(er / fit.r_sd_px, 2);
    normalised += (std::pow(ex / fit.cx_sd_px, 2) + std::pow(ey / fit.cy_sd_px, 2)) / 2;
  }
  const Errors errors{std::sqrt(squares / balls), std::sqrt(radius_squares / balls),
                      normalised / balls, radius_normalised / balls};
  ::testing::Test::RecordProperty("rms_px_" + pattern, std::to_string(errors.rms_px));
  std::printf(
      "%s: centre %.4f px rms, radius %.4f px, normalised errors squared %.2f, radius %.2f\n",
      pattern.c_str(), errors.rms_px, errors.radius_rms_px, errors.normalised,
      errors.radius_normalised);
  return errors;
}

// Errors are small, and no larger than stated: of 24 balls' coordinates chance alone moves the mean
// square by 0.29.
void expect_within(const Errors& errors, double rms_px) {
  EXPECT_LE(errors.rms_px, rms_px);
  EXPECT_LE(errors.normalised, 2);
  EXPECT_LE(errors.radius_normalised, 2);
}

TEST(CircleAccuracy, Plain) {
  expect_within(measure_balls("a1", {}), 0.005);
  expect_within(measure_balls("e1", {}), 0.01);
}

// The half level's crossings alone lie 0.2 px inside.
TEST(CircleAccuracy, FineInkAllAlongTheRim) {
  const Errors errors = measure_balls("a3", {});
  EXPECT_LE(errors.radius_rms_px, 0.04);
  EXPECT_LE(errors.rms_px, 0.015);
  // What the rim model misplaces is common to the whole rim; all else is four times too small.
  EXPECT_GT(std::sqrt(errors.radius_normalised), 0.5);
  EXPECT_LT(std::sqrt(errors.radius_normalised), 1.6);
}

// Packed dots as fine as the edge is wide: the radius is 0.05 px too small, 1.6 of what is stated
// where that is not doubted.
TEST(CircleAccuracy, DenseInkInABlurredEdge) {
  const Errors errors = measure_balls("f2", {.blur_px = 1});
  EXPECT_LE(errors.rms_px, 0.04);
  EXPECT_LE(errors.normalised, 2);
  EXPECT_LT(std::sqrt(errors.radius_normalised), 1.5);
  EXPECT_GT(std::sqrt(errors.radius_normalised), 0.5);
}

TEST(CircleAccuracy, ThirtyPercentOfTheRimHidden) {
  expect_within(measure_balls("a1", {.bar = true}), 0.01);
  // One frame of a dense ball by itself leaves 0.023 px: centre and radius go together.
  expect_within(measure_balls("e1", {.bar = true, .radius_known = true}), 0.02);
}

TEST(CircleAccuracy, FivePercentCompressed) {
  expect_within(measure_balls("a1", {.compression = 0.05}), 0.01);
  expect_within(measure_balls("e1", {.compression = 0.05}), 0.015);
}

TEST(CircleAccuracy, HiddenAndCompressed) {
  expect_within(measure_balls("a1", {.bar = true, .compression = 0.05, .radius_known = true}),
                0.05);
  expect_within(measure_balls("e1", {.bar = true, .compression = 0.05, .radius_known = true}), 0.5);
}

// Beside the picture's edge the bar looked like more of the ball, and the circle that takes it all
// in was 1.6 px off with 0.3 px stated.
TEST(CircleAccuracy, ABarBesideTheEdgeIsNotABallsOtherHalf) {
  Condition condition{.bar = true, .compression = 0.05, .radius_known = true};
  condition.cut_close = true;
  expect_within(measure_balls("a1", condition), 0.02);
}

TEST(CircleAccuracy, Shaded) {
  expect_within(measure_balls("a1", {.shading = 0.5}), 0.05);
  expect_within(measure_balls("e1", {.shading = 0.5}), 0.05);
}

// A dense ball that has just been touched, followed from the frame before: where a fit stops short
// of the likelihood's maximum, its curvature there states no deviation at all.
TEST(CircleAccuracy, NoDeviationIsNothing) {
  for (int seed = 13; seed <= 15; ++seed) {
    const BallPose pose{136 + std::fmod(0.3819660113 * seed + 0.13, 1),
                        136 + std::fmod(0.6180339887 * seed + 0.41, 1), 17.0 * seed, 0.002, 90};
    SynthScene scene;
    scene.width = scene.height = 272;
    scene.noise_sigma = 2;
    scene.noise_seed = static_cast<std::uint64_t>(seed) + 1;
    const sim::speckle::BallRenderer renderer(painted("e1", seed), scene);
    Frame first, second;
    renderer.render(pose, 0, first);
    renderer.render(pose, 1, second);
    const circle::CircleFit before = circle::measure_circle(
        first, {.predicted = {pose.cx_px + 1.3, pose.cy_px - 0.9, kRadius + 0.4}}, {});
    circle::CirclePrior prior;
    prior.predicted = {pose.cx_px + 0.21, pose.cy_px - 0.17, kRadius + 0.1};
    prior.centre_sd_px = prior.rim_sd_px.emplace(0.3);
    prior.bright = before.bright;
    prior.rim_model = before.rim_model;
    for (const Frame* frame : {&first, &second}) {
      const circle::CircleFit fit = circle::measure_circle(*frame, prior, {});
      ASSERT_EQ(fit.status, circle::CircleStatus::kOk) << seed;
      EXPECT_GT(std::min({fit.cx_sd_px, fit.cy_sd_px, fit.r_sd_px}), 1e-3) << seed;
    }
  }
}

// Errors over their stated deviations have unit variance. 120 balls make 240 of them, so that their
// mean square is known to 9 %; neighbouring pictures of a pattern share no noise.
TEST(CircleAccuracy, DeviationsAreHonest) {
  double sum = 0, radius_sum = 0;
  const std::vector<std::string> patterns = {"a1", "b1", "c1", "d1", "e1"};
  for (const std::string& pattern : patterns) {
    const Errors errors = measure_balls(pattern, {}, 24);
    sum += errors.normalised;
    radius_sum += errors.radius_normalised;
  }
  const double deviation = std::sqrt(sum / static_cast<double>(patterns.size()));
  EXPECT_GT(deviation, 0.85);
  EXPECT_LT(deviation, 1.15);
  // Errors of the radius are partly a pattern's, not a ball's: fewer of them are independent.
  const double radius = std::sqrt(radius_sum / static_cast<double>(patterns.size()));
  EXPECT_GT(radius, 0.6);
  EXPECT_LT(radius, 1.2);
}

}  // namespace
}  // namespace impactdic
