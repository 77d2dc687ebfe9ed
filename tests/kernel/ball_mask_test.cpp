// rigid.cl with a mask: which pixels of the pictures count.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

#include "host/dic/device/ball.h"
#include "tests/support/engine.h"
#include "tests/support/speckle_frames.h"

namespace impactdic {
namespace {

using testing::pose;
using testing::shared_engine;

constexpr int kWidth = 157, kHeight = 150;
constexpr double kRadiusPx = 60;

// The picture about the frame, which is its part from (10, 6) on.
Frame in_larger(const Frame& frame) {
  Frame larger;
  larger.reset(frame.width() + 20, frame.height() + 12, 8);
  std::fill(larger.u8.data(), larger.u8.data() + larger.u8.size(), std::uint8_t{30});
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) larger.u8(x + 10, y + 6) = frame.u8(x, y);
  }
  return larger;
}

// Two halves of a picture that move apart: each mask sees its own.
TEST(BallMask, OnlyItsPixelsCount) {
  SynthScene scene;
  scene.width = kWidth;
  scene.height = kHeight;
  const auto pictures =
      testing::render_frames(testing::quick_ball(6, kRadiusPx), scene,
                             {pose(76, 74, 0), pose(76.4, 73.7, 2), pose(75.5, 74.6, -1.5)});
  Frame second = pictures[1];
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 76; x < kWidth; ++x) second.u8(x, y) = pictures[2].u8(x, y);
  }
  dic::DeviceFrames frames(shared_engine(), 2);
  frames.set(0, pictures[0]);
  frames.set(1, second);
  for (const bool left : {true, false}) {
    dic::BallOptions options;
    auto mask = std::make_shared<Image<std::uint8_t>>(kWidth, kHeight, 0);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) (*mask)(x, y) = left ? x < 68 : x > 84;
    }
    options.mask = mask;
    options.mask_is_body = true;
    const BallTask task{0, 1, 76, 74, kRadiusPx - 4, 0, 0, 0, 0, 0, 0, {}};
    const BallMotion motion =
        dic::BallRegistration(shared_engine(), options).measure(frames, {&task, 1})[0];
    ASSERT_EQ(motion.status, static_cast<idic_int>(WindowStatus::kOk)) << left;
    EXPECT_NEAR(motion.dx, left ? 0.4 : -0.5, 0.01) << left;
    EXPECT_NEAR(motion.dy, left ? -0.3 : 0.6, 0.01) << left;
    EXPECT_NEAR(motion.rot_rad * 180 / M_PI, left ? 2 : -1.5, 0.02) << left;
    // A mask of the pictures that the frames are parts of.
    auto whole = std::make_shared<Image<std::uint8_t>>(kWidth + 20, kHeight + 12, 1);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) (*whole)(x + 10, y + 6) = (*mask)(x, y);
    }
    dic::BallOptions of_parts;
    of_parts.mask = whole;
    const Frame larger[] = {in_larger(pictures[0]), in_larger(second)};
    const dic::FramePart parts[] = {{&larger[0], 10, 6}, {&larger[1], 10, 6}};
    dic::DeviceFrames cut(shared_engine(), 2);
    cut.set(0, parts, kWidth, kHeight);
    const BallMotion same =
        dic::BallRegistration(shared_engine(), of_parts).measure(cut, {&task, 1})[0];
    EXPECT_EQ(same.dx, motion.dx) << left;
    EXPECT_EQ(same.rot_rad, motion.rot_rad) << left;
    EXPECT_NEAR(same.used, 0.4, 0.05) << left;  // of the disc
  }
  dic::BallOptions options;
  options.mask = std::make_shared<Image<std::uint8_t>>(kWidth - 1, kHeight, 1);
  const BallTask task{0, 1, 76, 74, kRadiusPx - 4, 0, 0, 0, 0, 0, 0, {}};
  EXPECT_THROW(dic::BallRegistration(shared_engine(), options).measure(frames, {&task, 1}),
               InvalidArgument);
}

}  // namespace
}  // namespace impactdic
