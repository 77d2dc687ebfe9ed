// `correlate_clip`: neither copies that run ahead nor threads change a result.
#include "host/pipeline/correlate_clip.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <bit>

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
  double dx_px;
  std::string bits;
};

std::vector<Row> correlate(FrameSource& clip, ReferenceFrame reference, int workers) {
  pipeline::CorrelateOptions options;
  options.frames = {0, clip.info().frame_count, 1};
  options.roi = {40, 44, 60, 60};
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
    rows.push_back({frame.status, frame.motion.dx_px, text});
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
