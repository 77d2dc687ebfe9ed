// Time of the ball's circle per frame, with its error beside it (px, both axes, over the frames).
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "host/circle/circle.h"
#include "sim/speckle/render.h"

namespace impactdic::bench {
namespace {

constexpr double kUsual = 115, kSmall = 63;  // radius, px
constexpr int kFrames = 8;

struct Clip {
  std::vector<Frame> frames;
  std::vector<BallPose> poses;
};

// A ball in 512×512, noise 2, at incommensurate places.
Clip make_clip(const std::string& pattern, double radius_px) {
  Clip clip;
  SynthScene scene;
  scene.noise_sigma = 2;
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball(pattern, 7, radius_px), scene);
  for (int k = 0; k < kFrames; ++k) {
    const BallPose pose{250.13 + 0.618 * k, 261.41 - 0.382 * k, 17.0 * k};
    clip.poses.push_back(pose);
    renderer.render(pose, k, clip.frames.emplace_back());
  }
  return clip;
}

// What is known of the ball beforehand: its place to a fraction of a pixel; and its rim
// model, as in the middle of a clip; and its place to a few hundredths, from frames before and
// behind.
enum class Known { kPlace, kModel, kBetween };

circle::CirclePrior near(const BallPose& pose, double radius_px, Known known,
                         circle::CirclePrior prior) {
  const double off = known == Known::kBetween ? 0.1 : 1;
  prior.centre_sd_px = known == Known::kBetween ? 0.05 : 0.3;
  prior.predicted = {pose.cx_px + 0.21 * off, pose.cy_px - 0.17 * off, radius_px + 0.1 * off};
  return prior;
}

// `small`: a ball of radius 63 px.
void measure(benchmark::State& state, const std::string& pattern, double radius_px, Known known) {
  const Clip clip = make_clip(pattern, radius_px);
  double squares = 0;
  std::int64_t n = 0;
  circle::CirclePrior prior;
  prior.rim_sd_px = 0.3;
  prior.bright = true;
  if (known != Known::kPlace) {
    const circle::CirclePrior first = near(clip.poses[0], radius_px, Known::kPlace, prior);
    prior.rim_model = circle::measure_circle(clip.frames[0], first, {}).rim_model;
  }
  for (auto _ : state) {
    const int k = static_cast<int>(n % kFrames);
    const BallPose& truth = clip.poses[k];
    prior = near(truth, radius_px, known, prior);
    const circle::CircleFit fit = circle::measure_circle(clip.frames[k], prior, {});
    benchmark::DoNotOptimize(fit);
    squares +=
        std::pow(fit.circle.cx_px - truth.cx_px, 2) + std::pow(fit.circle.cy_px - truth.cy_px, 2);
    ++n;
  }
  state.counters["rms_error_px"] = std::sqrt(squares / (2.0 * static_cast<double>(n)));
}

void find(benchmark::State& state, const std::string& pattern) {
  const Clip clip = make_clip(pattern, kUsual);
  double worst = 0;
  std::int64_t n = 0;
  for (auto _ : state) {
    const int k = static_cast<int>(n++ % kFrames);
    const auto found = circle::find_ball(clip.frames[k], {});
    worst = std::max(worst, found ? std::hypot(found->cx_px - clip.poses[k].cx_px,
                                               found->cy_px - clip.poses[k].cy_px)
                                  : INFINITY);
  }
  state.counters["worst_error_px"] = worst;
}

BENCHMARK_CAPTURE(measure, followed_a1, "a1", kUsual, Known::kModel)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, followed_b1, "b1", kUsual, Known::kModel)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, followed_d3, "d3", kUsual, Known::kModel)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, followed_e1, "e1", kUsual, Known::kModel)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, between_a1, "a1", kUsual, Known::kBetween)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, between_b1, "b1", kUsual, Known::kBetween)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, between_d3, "d3", kUsual, Known::kBetween)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, between_e1, "e1", kUsual, Known::kBetween)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, small_a1, "a1", kSmall, Known::kModel)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, small_b1, "b1", kSmall, Known::kModel)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, small_d3, "d3", kSmall, Known::kModel)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, small_e1, "e1", kSmall, Known::kModel)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, alone_a1, "a1", kUsual, Known::kPlace)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, alone_b1, "b1", kUsual, Known::kPlace)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, alone_d3, "d3", kUsual, Known::kPlace)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, alone_e1, "e1", kUsual, Known::kPlace)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(find, b1, "b1")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(find, e1, "e1")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace impactdic::bench

BENCHMARK_MAIN();
