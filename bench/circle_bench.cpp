// Time of the ball's circle per frame, with its error beside it (px, both axes, over the frames).
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "host/track/circle.h"
#include "sim/speckle/render.h"

namespace impactdic {
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
  Scene scene;
  scene.noise_sigma = 2;
  const BallRenderer renderer(paint_ball(pattern, 7, radius_px), scene);
  for (int k = 0; k < kFrames; ++k) {
    const BallPose pose{250.13 + 0.618 * k, 261.41 - 0.382 * k, 17.0 * k};
    clip.poses.push_back(pose);
    renderer.render(pose, k, clip.frames.emplace_back());
  }
  return clip;
}

CirclePrior near(const BallPose& pose, double radius_px, CirclePrior prior) {
  prior.predicted = {pose.cx_px + 0.21, pose.cy_px - 0.17, radius_px + 0.1};
  return prior;
}

// Predicted to a fraction of a pixel. `followed`: as in the middle of a clip, the look of the rim
// known from a frame before. `small`: a ball of radius 63 px.
void measure(benchmark::State& state, const std::string& pattern, double radius_px, bool followed) {
  const Clip clip = make_clip(pattern, radius_px);
  double squares = 0;
  std::int64_t n = 0;
  CirclePrior prior;
  prior.centre_sd_px = 0.3;
  prior.rim_sd_px = 0.3;
  prior.bright = true;
  if (followed)
    prior.look = measure_circle(clip.frames[0], near(clip.poses[0], radius_px, prior), {}).look;
  for (auto _ : state) {
    const int k = static_cast<int>(n % kFrames);
    const BallPose& truth = clip.poses[k];
    prior = near(truth, radius_px, prior);
    const CircleFit fit = measure_circle(clip.frames[k], prior, {});
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
    const auto found = find_ball(clip.frames[k], {});
    worst = std::max(worst, found ? std::hypot(found->cx_px - clip.poses[k].cx_px,
                                               found->cy_px - clip.poses[k].cy_px)
                                  : INFINITY);
  }
  state.counters["worst_error_px"] = worst;
}

BENCHMARK_CAPTURE(measure, followed_a1, "a1", kUsual, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, followed_b1, "b1", kUsual, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, followed_d3, "d3", kUsual, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, followed_e1, "e1", kUsual, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, small_a1, "a1", kSmall, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, small_b1, "b1", kSmall, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, small_d3, "d3", kSmall, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, small_e1, "e1", kSmall, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, alone_a1, "a1", kUsual, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, alone_b1, "b1", kUsual, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, alone_d3, "d3", kUsual, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(measure, alone_e1, "e1", kUsual, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(find, b1, "b1")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(find, e1, "e1")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace impactdic

BENCHMARK_MAIN();
