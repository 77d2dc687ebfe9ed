// Circles that are followed on the device, their sums read back and described by the host.
#include <algorithm>
#include <cmath>

#include "host/benchmark/measure.h"
#include "host/circle/device/rim_follower.h"
#include "sim/speckle/render.h"

namespace impactdic::benchmark {
namespace {

constexpr double kRimRadius = 115;
constexpr int kCirclePictures = 8;

// As the frames beside it foretell it.
circle::CirclePrior expected(const BallPose& pose) {
  circle::CirclePrior prior;
  prior.predicted = {pose.cx_px + 0.021, pose.cy_px - 0.017, kRimRadius + 0.01};
  prior.centre_sd_px = 0.05;
  prior.rim_sd_px = 0.3;
  return prior;
}

}  // namespace

void bench_circle(opencl::Engine& engine, const BenchOptions& options, const RowSink& sink) {
  const std::string work = "circle r 115 e1";
  if (work.find(options.only) == std::string::npos) return;
  if (!circle::RimFollower::serves(engine.device(), {})) return;
  const int batch = options.batch > 0 ? options.batch : engine.device().is_gpu ? 256 : 8;
  SynthScene scene;
  scene.noise_sigma = 2;
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("e1", 7, kRimRadius), scene);
  std::vector<Frame> pictures(kCirclePictures);
  std::vector<BallPose> poses;
  for (int k = 0; k < kCirclePictures; ++k) {
    poses.push_back({250.13 + 0.618 * k, 261.41 - 0.382 * k, 17.0 * k});
    renderer.render(poses.back(), k, pictures[static_cast<std::size_t>(k)]);
  }
  const circle::CircleFit learnt = circle::measure_circle(pictures[0], expected(poses[0]), {});
  dic::DeviceFrames frames(engine, batch);
  std::vector<circle::RimToFollow> rims;
  for (int k = 0; k < batch; ++k) {
    const auto picture = static_cast<std::size_t>(k % kCirclePictures);
    frames.set(k, pictures[picture]);
    circle::RimToFollow& rim = rims.emplace_back();
    rim.frame = &pictures[picture];
    rim.slot = k;
    rim.prior = expected(poses[picture]);
    rim.prior.rim_model = learnt.rim_model;
    rim.prior.bright = learnt.bright;
  }
  circle::RimFollower follower(engine, {});
  BenchRow row;
  row.work = work;
  row.variant = "expected to 0.03 px";
  row.unit = "frames";
  row.count = batch;
  std::vector<std::optional<circle::CircleFit>> fits;
  measure_time(row, options.seconds, [&] { fits = follower.follow(frames, rims); });
  double squares = 0;
  int ok = 0;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    if (!fits[k]) continue;
    const BallPose& at = poses[k % kCirclePictures];
    squares += std::pow(fits[k]->circle.cx_px - at.cx_px, 2) +
               std::pow(fits[k]->circle.cy_px - at.cy_px, 2);
    ++ok;
  }
  row.lost = 1 - ok / static_cast<double>(batch);
  row.rms_px = std::sqrt(squares / std::max(2.0 * ok, 1.0));
  // Some 650 lines of seven samples and 44 numbers that lie in memory; in each of a dozen sums some
  // 300 operations, in each of two models of a line 600.
  row.bytes = 650 * (7 * 4 + 44 * 4.0);
  row.flops = 650 * (12 * 300 + 2 * 1200.0);
  sink(row);
}

}  // namespace impactdic::benchmark
