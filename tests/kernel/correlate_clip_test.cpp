// `correlate_clip`: neither copies that run ahead nor threads change a result.
#include "host/pipeline/correlate_clip.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include "tests/support/rendered_clip.h"
#include "tests/support/speckle_frames.h"

namespace impactdic::testing {
namespace {

// Creeps, then jumps farther than windows look, so that it has to be searched anew.
std::vector<Frame> jumping_frames() {
  SynthScene scene;
  scene.width = scene.height = 160;
  scene.noise_sigma = 1;
  std::vector<BallPose> poses;
  for (int k = 0; k < 20; ++k) {
    poses.push_back(pose(70 + 0.37 * k + (k < 13 ? 0 : 17), 74 + 0.11 * k, 0.4 * k));
  }
  return render_frames(quick_ball(5, 60), scene, poses);
}

struct Row {
  TrackStatus status;
  double dx_px, rot_deg;
  std::string bits;
};

std::vector<Row> correlate(FrameSource& clip, ReferenceFrame reference, int workers,
                           const Roi& roi = {40, 44, 60, 60}) {
  pipeline::CorrelateOptions options;
  options.frames = {0, clip.info().frame_count, 1};
  options.roi = roi;
  options.reference = reference;
  options.workers = workers;
  std::vector<Row> rows;
  const auto sink = [&](const pipeline::CorrelatedFrame& frame) {
    EXPECT_EQ(frame.frame, static_cast<std::int64_t>(rows.size()));
    std::string text;
    for (const double value : {frame.motion.dx_px, frame.motion.dy_px, frame.motion.rot_rad,
                               frame.motion.dx_sd_px, frame.motion.rot_sd_rad}) {
      text += " " + std::to_string(std::bit_cast<std::uint64_t>(value));
    }
    for (const WindowMotion& m : frame.field) {
      for (const float value : {m.u, m.v, m.u_sd, m.correlation}) {
        text += " " + std::to_string(std::bit_cast<std::uint32_t>(value));
      }
    }
    rows.push_back({frame.status, frame.motion.dx_px, frame.motion.rot_rad * 180 / M_PI, text});
  };
  pipeline::correlate_clip(clip, shared_engine(), options, sink, [](std::int64_t, std::int64_t) {});
  return rows;
}

class CorrelateClip : public ::testing::TestWithParam<ReferenceFrame> {};

TEST_P(CorrelateClip, CopiesAheadChangeNothing) {
  MemoryClip clip(jumping_frames());
  const std::vector<Row> plain = correlate(clip, GetParam(), 1),
                         ahead = correlate(clip, GetParam(), 2);
  ASSERT_EQ(plain.size(), 20u);
  ASSERT_EQ(ahead.size(), 20u);
  for (std::size_t k = 0; k < plain.size(); ++k) {
    EXPECT_EQ(plain[k].bits, ahead[k].bits) << k;
    EXPECT_EQ(plain[k].status, TrackStatus::kOk) << k;
    // Of the region's centre, which is not the ball's.
    const double turn = 0.4 * M_PI / 180, from_centre = 73.5 - 74;
    const double step = GetParam() == ReferenceFrame::kFirst ? k : k == 0 ? 0 : 1;
    const double jump = GetParam() == ReferenceFrame::kFirst ? k >= 13 : k == 13;
    EXPECT_NEAR(plain[k].dx_px, 0.37 * step + 17 * jump + from_centre * turn * step, 0.08) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(References, CorrelateClip,
                         ::testing::Values(ReferenceFrame::kFirst, ReferenceFrame::kPrevious));

// Three alike parts about the centre, 120 degrees apart, and as much of a fourth kind as `unlike`
// says: the picture turned by 60 degrees is nearly the one turned by -60 or by 180.
std::vector<Frame> three_parts(double unlike, std::uint64_t seed, double turn_deg = 60) {
  constexpr int kSide = 200;
  constexpr double kThird = 2 * M_PI / 3;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> part(0, 1);
  struct Speck {
    double x, y, r;
  };
  std::vector<Speck> specks;
  const auto add = [&](double radius, double angle, double r) {
    specks.push_back({radius * std::cos(angle), radius * std::sin(angle), r});
  };
  for (int i = 0; i < 220; ++i) {
    const double radius = 95 * std::sqrt(part(random)), angle = kThird * part(random);
    const double r = 2 + 2 * part(random);
    const bool is_alike = part(random) >= unlike;
    for (int k = 0; k < 3; ++k) {
      add(is_alike ? radius : 95 * std::sqrt(part(random)),
          (is_alike ? angle : kThird * part(random)) + k * kThird, r);
    }
  }
  std::vector<Frame> frames;
  for (const double turn : {0.0, turn_deg * M_PI / 180}) {
    Frame& frame = frames.emplace_back();
    frame.reset(kSide, kSide, 8);
    std::fill_n(frame.u8.data(), frame.u8.size(), std::uint8_t{190});
    const double c = std::cos(turn), s = std::sin(turn);
    for (const Speck& speck : specks) {  // counter-clockwise on the screen
      const double x = 99.5 + c * speck.x + s * speck.y, y = 99.5 - s * speck.x + c * speck.y;
      for (int j = static_cast<int>(y) - 6; j <= y + 6; ++j) {
        for (int i = static_cast<int>(x) - 6; i <= x + 6; ++i) {
          if (i < 0 || j < 0 || i >= kSide || j >= kSide) continue;
          const double ink = std::clamp(speck.r + 0.5 - std::hypot(i - x, j - y), 0.0, 1.0);
          auto& pixel = frame.u8(i, j);
          pixel = static_cast<std::uint8_t>(std::lround(pixel + ink * (40.0 - pixel)));
        }
      }
    }
  }
  return frames;
}

constexpr Roi kParts = {30, 30, 140, 140};

// Where parts look alike nobody can tell the motion, and none is stated; where little is unlike,
// that tells.
TEST(CorrelateClip, AMotionThatFitsAsWellAsAnotherIsNotStated) {
  MemoryClip alike(three_parts(0, 1));
  const std::vector<Row> rows = correlate(alike, ReferenceFrame::kFirst, 1, kParts);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].status, TrackStatus::kInconsistent);
  MemoryClip unlike(three_parts(0.6, 1));
  const std::vector<Row> told = correlate(unlike, ReferenceFrame::kFirst, 1, kParts);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[1].status, TrackStatus::kOk);
  EXPECT_NEAR(told[1].rot_deg, 60, 0.05);
}

// Turned by 20 degrees they are also turned by -100 and by 140: two of eighteen were "ok" there.
TEST(CorrelateClip, ASmallTurnOfAlikePartsIsNoLargerOne) {
  for (std::uint64_t seed = 1; seed <= 18; ++seed) {
    MemoryClip clip(three_parts(0, seed, 20));
    const std::vector<Row> rows = correlate(clip, ReferenceFrame::kFirst, 1, kParts);
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[1].status, TrackStatus::kOk) << seed;
    EXPECT_NEAR(rows[1].rot_deg, 20, 0.02) << seed;
  }
}

// A surface that has moved on by more than is searched, 160 px: it was stated to have moved by 28
// px.
TEST(CorrelateClip, AShiftBeyondTheSearchIsNotStated) {
  SynthScene scene;
  scene.width = 420;
  scene.height = 200;
  scene.noise_sigma = 1;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const std::vector<Frame> wide =
        render_frames(quick_ball(seed, 260), scene, {pose(210, 100, 0)});
    std::vector<Frame> frames(2);
    crop(wide[0], {0, 0, 200, 200}, frames[0]);
    crop(wide[0], {160, 0, 200, 200}, frames[1]);
    MemoryClip clip(std::move(frames));
    const std::vector<Row> rows = correlate(clip, ReferenceFrame::kFirst, 1, kParts);
    ASSERT_EQ(rows.size(), 2u);
    const bool is_right = std::abs(rows[1].dx_px + 160) < 0.1;
    EXPECT_TRUE(rows[1].status != TrackStatus::kOk || is_right) << seed << ' ' << rows[1].dx_px;
  }
}

// Another surface: what few windows agree on by chance is not a motion.
TEST(CorrelateClip, WhatFewWindowsAgreeOnByChanceIsNotStated) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    MemoryClip clip({three_parts(1, seed)[0], three_parts(1, seed + 100)[0]});
    const std::vector<Row> rows = correlate(clip, ReferenceFrame::kFirst, 1, kParts);
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_NE(rows[1].status, TrackStatus::kOk) << seed;
  }
}

// A clip whose later frames cannot be read.
class BrokenClip : public FrameSource {
 public:
  explicit BrokenClip(std::vector<Frame> frames) : clip_(std::move(frames)) {}
  const ClipInfo& info() const override { return clip_.info(); }
  void read(std::int64_t index, Frame& frame) override {
    if (index >= 11) throw FormatError("clip", index, "this frame is damaged");
    clip_.read(index, frame);
  }

 private:
  MemoryClip clip_;
};

TEST(CorrelateClip, FramesBeforeADamagedOneAreMeasuredFirst) {
  BrokenClip clip(jumping_frames());
  pipeline::CorrelateOptions options;
  options.frames = {0, 20, 1};
  options.roi = {40, 44, 60, 60};
  int measured = 0;
  EXPECT_THROW(
      pipeline::correlate_clip(
          clip, shared_engine(), options, [&](const pipeline::CorrelatedFrame&) { ++measured; },
          [](std::int64_t, std::int64_t) {}),
      FormatError);
  EXPECT_EQ(measured, 11);
}

}  // namespace
}  // namespace impactdic::testing
