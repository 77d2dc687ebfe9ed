// Registration of whole balls, their splines included.
#include <cmath>
#include <numbers>
#include <random>

#include "host/benchmark/measure.h"
#include "host/dic/device/ball.h"
#include "host/dic/frames/spline_frames.h"
#include "sim/speckle/render.h"

namespace impactdic::benchmark {
namespace {

constexpr double kRadius = 115, kDegree = std::numbers::pi / 180;
constexpr int kBallPictures = 9;
constexpr double kStepX_px = 0.618, kStepY_px = -0.382;  // of the ball from picture to picture

// Discs of radius 1.6 … 4 px thrown at random, about half of the ball ink.
sim::speckle::SpeckleBall thrown_discs() {
  std::mt19937_64 random(12);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  sim::speckle::SpeckleBall ball;
  ball.radius_px = kRadius;
  for (double area = 0; area < 0.7 * kRadius * kRadius;) {
    const double x = kRadius * (2 * uniform() - 1), y = kRadius * (2 * uniform() - 1);
    const double radius = 1.6 + 2.4 * uniform();
    if (x * x + y * y > kRadius * kRadius) continue;
    ball.discs.push_back({x, y, radius});
    area += radius * radius;
  }
  return ball;
}

// How far the motions are from the true ones: along them (bias) and in all (rms).
void put_errors(const std::vector<BallTask>& tasks, const std::vector<BallMotion>& motions,
                BenchRow& row) {
  double squares = 0, along = 0;
  int ok = 0;
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    if (motions[k].status != static_cast<idic_int>(WindowStatus::kOk)) continue;
    const double way = tasks[k].guess_dx > 0 ? 1 : -1;
    const double du = motions[k].dx - kStepX_px * way, dv = motions[k].dy - kStepY_px * way;
    squares += du * du + dv * dv;
    along += way * (du * kStepX_px + dv * kStepY_px) / std::hypot(kStepX_px, kStepY_px);
    ++ok;
  }
  row.lost = 1 - ok / static_cast<double>(tasks.size());
  row.bias_px = ok > 0 ? along / ok : 0;
  row.rms_px = ok > 0 ? std::sqrt(squares / (2.0 * ok)) : 0;
}

}  // namespace

void bench_ball(opencl::Engine& engine, const BenchOptions& options, const RowSink& sink) {
  const std::string work = "ball r 115 degree 7";
  if (work.find(options.only) == std::string::npos) return;
  const int batch = options.batch > 0 ? options.batch : engine.device().is_gpu ? 256 : 4;
  SynthScene scene;
  scene.noise_sigma = 2;
  const sim::speckle::BallRenderer renderer(thrown_discs(), scene);
  std::vector<Frame> pictures(kBallPictures);
  std::vector<BallPose> poses(kBallPictures);
  for (int k = 0; k < kBallPictures; ++k) {
    BallPose& pose = poses[static_cast<std::size_t>(k)];
    pose.cx_px = 251.3 + kStepX_px * k;
    pose.cy_px = 259.2 + kStepY_px * k;
    pose.angle_deg = 0.5 * k;
    renderer.render(pose, k, pictures[static_cast<std::size_t>(k)]);
  }
  dic::DeviceFrames frames(engine, batch + 1);
  const dic::BallOptions defaults;
  dic::BallRegistration registration(engine, defaults);
  dic::SplineFrames splines(engine, defaults.spline_degree, defaults.presmooth_sigma_px, batch + 1);
  std::vector<BallTask> tasks;
  for (int k = 0; k <= batch; ++k) {
    // To and fro through the pictures that there are.
    const auto place = [](int frame) { return frame % 16 < 8 ? frame % 16 : 16 - frame % 16; };
    frames.set(k, pictures[static_cast<std::size_t>(place(k))]);
    if (k == batch) continue;
    const BallPose& at = poses[static_cast<std::size_t>(place(k))];
    const auto way = static_cast<float>(place(k + 1) - place(k));
    tasks.push_back({k, k + 1, static_cast<float>(at.cx_px), static_cast<float>(at.cy_px),
                     static_cast<float>(kRadius - dic::kRimMarginPx), 0.6F * way, -0.4F * way,
                     static_cast<float>(0.52 * kDegree) * way});
  }
  BenchRow row;
  row.work = work;
  row.variant = "splines included";
  row.unit = "frames";
  row.count = batch;
  std::vector<BallMotion> motions;
  measure_time(row, options.seconds, [&] {
    splines.forget();
    splines.prepare(frames);
    motions = registration.measure(frames, tasks);
  });
  put_errors(tasks, motions, row);
  const double area = scene.width * scene.height, disc = std::numbers::pi * 111 * 111;
  row.bytes = area * (4 + 4 + 4 + 4 + 4 + 12) + disc * 16;
  row.flops = disc * (4 * (2 * 64 + 60) + 100.0) + area * 400;
  sink(row);
}

}  // namespace impactdic::benchmark
