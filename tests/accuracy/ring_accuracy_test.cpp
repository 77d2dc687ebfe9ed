// How exactly the ring measures the turn of rendered and real pictures.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "host/dic/device/ring.h"
#include "host/video/frame_source.h"
#include "tests/support/data.h"
#include "tests/support/engine.h"
#include "tests/support/speckle_frames.h"

namespace impactdic {
namespace {

using testing::pose;
using testing::shared_engine;

constexpr double kDegree = std::numbers::pi / 180;

RingTask ring_task(const BallPose& first, const BallPose& second, double inner, double outer) {
  RingTask task{};
  task.second = 1;
  task.cx_first = static_cast<float>(first.cx_px);
  task.cy_first = static_cast<float>(first.cy_px);
  task.cx_second = static_cast<float>(second.cx_px);
  task.cy_second = static_cast<float>(second.cy_px);
  task.inner = static_cast<float>(inner);
  task.outer = static_cast<float>(outer);
  return task;
}

struct Case {
  const char* name;
  double noise, rotation_deg;
};

class Ring : public ::testing::TestWithParam<Case> {};

// Any turn, without a guess, at noise 2.
TEST_P(Ring, TurnOfAPaintedBall) {
  const auto [name, noise, rotation_deg] = GetParam();
  static const sim::speckle::SpeckleBall ball = sim::speckle::paint_ball("e1", 2, 115);
  opencl::Engine& engine = shared_engine();
  SynthScene scene;
  scene.width = scene.height = 280;
  scene.noise_sigma = noise;
  constexpr int kPairs = 8;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> off(-1, 1);
  std::vector<BallPose> poses;
  for (int k = 0; k < kPairs; ++k) {
    poses.push_back(pose(140 + off(random), 140 + off(random), 180 * off(random)));
    poses.push_back(pose(poses.back().cx_px + off(random), poses.back().cy_px + off(random),
                         poses.back().angle_deg + rotation_deg + 0.3 * off(random)));
  }
  const auto pictures = testing::render_frames(ball, scene, poses);
  dic::DeviceFrames frames(engine, 2 * kPairs);
  dic::RingRotation ring(engine, {});
  std::vector<RingTask> tasks;
  for (int k = 0; k < 2 * kPairs; ++k) {
    frames.set(k, pictures[static_cast<std::size_t>(k)]);
    if (k % 2 == 0) continue;
    const auto at = static_cast<std::size_t>(k);
    tasks.push_back(ring_task(poses[at - 1], poses[at], 20, 110));
    tasks.back().first = k - 1;
    tasks.back().second = k;
  }
  const auto motions = ring.measure(frames, tasks);
  double squares = 0, normalised = 0;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    ASSERT_EQ(motions[k].status, WindowStatus::kOk);
    const double error = std::remainder(
        motions[k].rot_rad / kDegree - (poses[2 * k + 1].angle_deg - poses[2 * k].angle_deg), 360);
    squares += error * error / kPairs;
    normalised += std::pow(error * kDegree / motions[k].rot_sd_rad, 2) / kPairs;
    EXPECT_GT(motions[k].peak_ratio, 1.5);
  }
  std::printf("%s: rms %.5f deg, over sd %.2f\n", name, std::sqrt(squares), std::sqrt(normalised));
  EXPECT_LE(std::sqrt(squares), 0.0007);
}
INSTANTIATE_TEST_SUITE_P(Cases, Ring,
                         ::testing::Values(Case{"exact3", 0, 3}, Case{"turn3", 2, 3},
                                           Case{"turn20", 2, 20}, Case{"turn90", 2, 90},
                                           Case{"turn170", 2, 170}, Case{"turn_back", 2, -120}),
                         [](const auto& info) { return std::string(info.param.name); });

// The picture of the DIC Challenge, turned by 170° counter-clockwise as seen on the screen (a
// negative angle in axes with y down).
TEST(RingOnRealPictures, Turned170Degrees) {
  IMPACTDIC_NEED_DATA("speckle/rotation_170.tif");
  opencl::Engine& engine = shared_engine();
  dic::DeviceFrames frames(engine, 2);
  dic::RingRotation ring(engine, {});
  const char* names[] = {"speckle/rotation_000.tif", "speckle/rotation_170.tif"};
  for (int k = 0; k < 2; ++k) {
    Frame frame;
    video::open_video({testing::data_path(names[k]).string()})->read(0, frame);
    frames.set(k, frame);
  }
  const BallPose middle = pose(256, 256, 0);
  const auto motions = ring.measure(frames, std::vector{ring_task(middle, middle, 20, 240)});
  ASSERT_EQ(motions[0].status, WindowStatus::kOk);
  std::printf("real: %.5f deg, sd %.5f, correlation %.4f\n", motions[0].rot_rad / kDegree,
              motions[0].rot_sd_rad / kDegree, motions[0].correlation);
  EXPECT_NEAR(motions[0].rot_rad / kDegree, 170, 0.002);
}

}  // namespace
}  // namespace impactdic
