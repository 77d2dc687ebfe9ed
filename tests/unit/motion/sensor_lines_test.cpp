// Columns and rows of a sensor that differ: told by a ball that passes over them, and taken off.
#include "host/advice/sensor_lines.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "sim/speckle/render.h"

namespace impactdic {
namespace {

constexpr int kWidth = 240, kHeight = 200, kFrames = 60;
constexpr double kRadius = 50;

BallPose pose_at(int frame) { return {75.0 + 1.5 * frame, 72.0 + 0.9 * frame, 0.7 * frame}; }

class Clip : public FrameSource {
 public:
  explicit Clip(const char* pattern) {
    SynthScene scene;
    scene.width = info_.width = kWidth;
    scene.height = info_.height = kHeight;
    scene.noise_sigma = 2;
    info_.frame_count = kFrames;
    info_.bits = 8;
    const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball(pattern, 3, kRadius), scene);
    frames.resize(kFrames);
    for (int i = 0; i < kFrames; ++i) {
      renderer.render(pose_at(i), i, frames[static_cast<std::size_t>(i)]);
    }
  }
  const ClipInfo& info() const override { return info_; }
  void read(std::int64_t index, Frame& frame) override {
    frame = frames[static_cast<std::size_t>(index)];
  }
  template <typename Change>
  void change(const Change& change) {
    for (Frame& frame : frames) {
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const double level = change(frame.u8(x, y), x, y);
          frame.u8(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(level), 0l, 255l));
        }
      }
    }
  }

  std::vector<Frame> frames;

 private:
  ClipInfo info_;
};

circle::BallCandidate seen_in(int every) {
  circle::BallCandidate ball;
  ball.radius_px = kRadius;
  for (int i = 2; i < kFrames; i += every) {
    const BallPose pose = pose_at(i);
    ball.sightings.push_back({i, {.circle = {pose.cx_px, pose.cy_px, kRadius}}});
  }
  return ball;
}

std::optional<advice::SensorLines> lines_in(Clip& clip) {
  return advice::sensor_lines(clip, {0, kFrames, 1}, {0, 0, kWidth, kHeight}, seen_in(5));
}

struct Lines {
  std::vector<double> offset, gain;
  double add(double level, int k) const {
    return level + offset[static_cast<std::size_t>(k)] + gain[static_cast<std::size_t>(k)] * level;
  }
};

Lines random_lines(int count) {
  std::mt19937 random(5);
  std::normal_distribution<double> offset(0, 3), gain(0, 0.02);
  Lines lines;
  for (int k = 0; k < count; ++k) {
    lines.offset.push_back(offset(random));
    lines.gain.push_back(gain(random));
  }
  return lines;
}

// rms of the steps from line to line at a level, of what is told less what is.
double left_of_steps(const video::LinePattern& told, const Lines& lines, double level, int from,
                     int to) {
  double sum = 0;
  const auto value = [&](int k) {
    const auto i = static_cast<std::size_t>(k);
    return told.offset[i] + told.gain[i] * (level - told.level) -
           (lines.offset[i] + lines.gain[i] * level);
  };
  for (int k = from; k < to; ++k) sum += std::pow(value(k + 1) - value(k), 2);
  return std::sqrt(sum / (to - from));
}

TEST(SensorLines, ThoseThatABallPassesOverAreTold) {
  for (const char* pattern : {"d1", "a2", "e1"}) {
    const Lines columns = random_lines(kWidth);
    Clip clip(pattern);
    clip.change([&](double level, int x, int) { return columns.add(level, x); });
    const auto told = lines_in(clip);
    ASSERT_TRUE(told) << pattern;
    EXPECT_TRUE(told->pattern.rows.offset.empty()) << pattern;
    EXPECT_NEAR(told->columns_rms, 4, 1.5) << pattern;
    EXPECT_LT(left_of_steps(told->pattern.columns, columns, 150, 60, 180), 2) << pattern;
    // Of a ball with little ink, ink's levels are known less.
    const std::vector<float> none(kWidth, 0.0f);
    EXPECT_LT(left_of_steps(told->pattern.columns, columns, 40, 60, 180),
              0.8 * left_of_steps({none, none, 0}, columns, 40, 60, 180))
        << pattern;
  }
}

TEST(SensorLines, RowsAreToldLikewise) {
  const Lines rows = random_lines(kHeight);
  Clip clip("a2");
  clip.change([&](double level, int, int y) { return rows.add(level, y); });
  const auto told = lines_in(clip);
  ASSERT_TRUE(told);
  EXPECT_TRUE(told->pattern.columns.offset.empty());
  EXPECT_LT(left_of_steps(told->pattern.rows, rows, 150, 60, 130), 2);
}

TEST(SensorLines, AnEvenSensorHasNone) {
  for (const char* pattern : {"d1", "a2", "e1", "e2", "f1", "c3"}) {
    Clip clip(pattern);
    EXPECT_FALSE(lines_in(clip)) << pattern;
  }
}

// Neither are wires before the ball, nor a wall of planks behind it.
TEST(SensorLines, WhatStandsInTheRoomIsNone) {
  Clip clip("a2");
  clip.change([&](double level, int x, int) { return x % 40 < 2 ? 120 : level; });
  EXPECT_FALSE(lines_in(clip));
  Clip planks("a2");
  for (int i = 0; i < kFrames; ++i) {
    Frame& frame = planks.frames[static_cast<std::size_t>(i)];
    const BallPose pose = pose_at(i);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (std::hypot(x - pose.cx_px, y - pose.cy_px) < kRadius + 1.5) continue;
        frame.u8(x, y) = static_cast<std::uint8_t>(frame.u8(x, y) + 20 * (x % 7 < 3));
      }
    }
  }
  EXPECT_FALSE(lines_in(planks));
}

TEST(SensorLines, AreTakenOffButAtTheScalesEnds) {
  auto clip = std::make_shared<Clip>("a2");
  Frame& stored = clip->frames[0];
  for (int x = 0; x < kWidth; ++x) stored.u8(x, 0) = 100;
  stored.u8(7, 0) = 255;
  stored.u8(8, 0) = 0;
  video::SensorPattern pattern;
  pattern.columns.offset.assign(kWidth, 0);
  pattern.columns.gain.assign(kWidth, 0);
  pattern.columns.level = 80;
  pattern.columns.offset[5] = pattern.columns.offset[7] = pattern.columns.offset[8] = 4;
  pattern.columns.gain[5] = 0.05f;
  const auto even = video::even_lines(clip, pattern);
  EXPECT_EQ(even->info().bits, 16);
  Frame frame;
  even->read(0, frame);
  EXPECT_EQ(frame.u16(4, 0), 257 * 100);
  EXPECT_NEAR(frame.u16(5, 0), 257 * (100 - 4 - 0.05 * 20), 1);
  EXPECT_EQ(frame.u16(7, 0), 65535);
  EXPECT_EQ(frame.u16(8, 0), 0);
  pattern.columns.offset.pop_back();
  EXPECT_THROW(video::even_lines(clip, pattern), InvalidArgument);
}

}  // namespace
}  // namespace impactdic
