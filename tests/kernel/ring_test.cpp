// ring.cl against its double-precision reference.
#include "host/dic/device/ring.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/motion/estimators.h"
#include "tests/support/engine.h"
#include "tests/support/speckle_frames.h"

namespace impactdic {
namespace {

using testing::pose;
using testing::shared_engine;

TEST(RingKernel, GivesWhatTheReferenceGives) {
  opencl::Engine& engine = shared_engine();
  SynthScene scene;
  scene.width = 160;
  scene.height = 151;
  scene.noise_sigma = 2;
  const auto pictures =
      testing::render_frames(testing::quick_ball(3, 65), scene,
                             {pose(79.3, 74.4, 0), pose(80.67, 75.79, 131), pose(78.2, 74.9, -40)});
  dic::RingOptions options;
  options.rings = 21;
  options.angles = 210;  // no multiple of a work-group's usual size
  for (const int degree : {3, 7}) {
    options.spline_degree = degree;
    dic::DeviceFrames frames(engine, 3);
    dic::RingRotation ring(engine, options);
    for (int k = 0; k < 3; ++k) {
      frames.set(k, pictures[static_cast<std::size_t>(k)]);
    }
    RingTask task{0, 1, 79.3f, 74.4f, 80.67f, 75.79f, 9.0f, 60.0f};
    RingTask other{1, 2, 80.67f, 75.79f, 78.2f, 74.9f, 20.0f, 50.5f};
    RingTask outside = task;
    outside.outer = 90;
    // More than one batch.
    std::vector<RingTask> tasks(17, task);
    tasks.push_back(other);
    tasks.push_back(outside);
    const auto motions = ring.measure(frames, tasks);
    ASSERT_EQ(motions.size(), tasks.size());
    const dic::RingMotion expected = dic::ring_reference(pictures[0], pictures[1], task, options);
    const dic::RingMotion expected_other =
        dic::ring_reference(pictures[1], pictures[2], other, options);
    ASSERT_EQ(expected.status, WindowStatus::kOk);
    for (std::size_t k = 0; k < 18; ++k) {
      const dic::RingMotion& want = k < 17 ? expected : expected_other;
      ASSERT_EQ(motions[k].status, WindowStatus::kOk);
      // 1e-4 px at the rim.
      EXPECT_NEAR(motions[k].rot_rad, want.rot_rad, 1e-4 / 60);
      EXPECT_NEAR(motions[k].correlation, want.correlation, 1e-5);
      EXPECT_NEAR(motions[k].rot_sd_rad, want.rot_sd_rad, 1e-3 * want.rot_sd_rad);
      EXPECT_NEAR(motions[k].peak_ratio, want.peak_ratio, 1e-3);
    }
    EXPECT_EQ(motions[18].status, WindowStatus::kOutOfView);
    EXPECT_TRUE(std::isnan(motions[18].rot_rad));
  }
}

TEST(RingKernel, RefusesImpossibleTasks) {
  opencl::Engine& engine = shared_engine();
  dic::DeviceFrames frames(engine, 1);
  Frame frame;
  frame.reset(64, 64, 8);
  frames.set(0, frame);
  dic::RingRotation ring(engine, {});
  EXPECT_THROW(ring.measure(frames, std::vector{RingTask{0, 1, 32, 32, 32, 32, 5, 20}}),
               InvalidArgument);
  EXPECT_THROW(ring.measure(frames, std::vector{RingTask{0, 0, 32, 32, 32, 32, 20, 5}}),
               InvalidArgument);
  // A flat picture has no angle.
  const auto motions = ring.measure(frames, std::vector{RingTask{0, 0, 32, 32, 32, 32, 5, 20}});
  EXPECT_NE(motions[0].status, WindowStatus::kOk);
  dic::RingOptions options;
  options.angles = 17 * 61;
  EXPECT_THROW(dic::RingRotation(engine, options), InvalidArgument);
}

// A blob of the first frames of a ball that enters: its run ended with an error.
TEST(RingTask, OfABallOfSomePixelsHasAWidth) {
  for (const double radius_px : {2.0, 5.0, 6.0, 10.0, 40.0}) {
    const RingTask task = motion::ring_task({}, radius_px);
    EXPECT_GT(task.outer, task.inner) << radius_px;
    EXPECT_LT(task.outer, radius_px);
  }
}

}  // namespace
}  // namespace impactdic
