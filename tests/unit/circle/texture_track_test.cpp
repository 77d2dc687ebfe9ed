// Tracks of balls before wood and tiles, by the same run as a clip's file.
#include <gtest/gtest.h>
#include <impactdic/live/track_live.h>
#include <impactdic/track.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "tests/support/light_scenes.h"

namespace impactdic::testing {
namespace {

LightScene before(Backdrop backdrop, bool sphere) {
  return {.name = "texture",
          .sphere = sphere,
          .radius_px = 60,
          .lamp_share = 0.3,
          .backdrop = backdrop,
          .dx_px = 2.9,
          .dy_px = -1.6};
}

struct Rendered {
  std::vector<Frame> frames;
  std::vector<BallPose> poses;
  ClipInfo info;

  Rendered(const LightScene& scene, std::uint64_t seed, int count)
      : Rendered(scene, seed, count, 0, static_cast<std::size_t>(count)) {}
  // Frames first … last - 1 alone; the others are empty.
  Rendered(const LightScene& scene, std::uint64_t seed, int count, std::size_t first,
           std::size_t last) {
    LightClip clip(scene, seed, count);
    frames.resize(static_cast<std::size_t>(count));
    for (std::size_t k = first; k < last; ++k) clip.render(k, frames[k]);
    poses = clip.poses();
    info.width = clip.width();
    info.height = clip.height();
    info.bits = 8;
    info.format = "memory";
    info.frame_count = count;
    info.fps = 1000;
  }
};

class FromMemory : public FrameSource {
 public:
  explicit FromMemory(const Rendered& clip) : clip_(clip) {}
  const ClipInfo& info() const override { return clip_.info; }
  void read(std::int64_t index, Frame& frame) override {
    frame = clip_.frames.at(static_cast<std::size_t>(index));
  }

 private:
  const Rendered& clip_;
};

class Stream : public FrameStream {
 public:
  explicit Stream(const Rendered& clip) : clip_(clip), info_(clip.info) { info_.frame_count = 0; }
  const ClipInfo& info() const override { return info_; }
  bool next(Frame& frame) override {
    if (next_ == clip_.frames.size()) return false;
    frame = clip_.frames[next_++];
    return true;
  }
  void stop() override {}

 private:
  const Rendered& clip_;
  ClipInfo info_;
  std::size_t next_ = 0;
};

// Of circles and motions that are called right.
struct Errors {
  int circles = 0, motions = 0, wrong = 0;
  double squares_px = 0, chi_square = 0;

  void add(const TrackRow& row, const Rendered& clip) {
    const auto k = static_cast<std::size_t>(row.frame);
    const BallPose& truth = clip.poses[k];
    if (row.circle_ok) {
      ++circles;
      add_circle(row.cx_px - truth.cx_px, row.cx_sd_px);
      add_circle(row.cy_px - truth.cy_px, row.cy_sd_px);
      wrong += is_wrong(row.r_px - 60, row.r_sd_px);
    }
    if (!row.motion_ok || k + 1 == clip.poses.size()) return;
    ++motions;
    wrong += is_wrong(row.dx_px - (clip.poses[k + 1].cx_px - truth.cx_px), row.dx_sd_px);
    wrong += is_wrong(row.dy_px - (clip.poses[k + 1].cy_px - truth.cy_px), row.dy_sd_px);
  }
  double rms_px() const { return std::sqrt(squares_px / (2 * circles)); }
  double over_sd() const { return std::sqrt(chi_square / (2 * circles)); }

 private:
  static bool is_wrong(double off, double sd) {
    return std::abs(off) > 0.02 && std::abs(off) > 5 * sd;
  }
  void add_circle(double off, double sd) {
    wrong += is_wrong(off, sd);
    squares_px += off * off;
    chi_square += off * off / (sd * sd);
  }
};

Errors tracked(const Rendered& clip, Body body, bool with_field) {
  TrackRequest request;
  request.clip.source = std::make_shared<FromMemory>(clip);
  request.with_field = with_field;
  request.body = body;
  request.radius_px = {50, 70};
  Session session;
  const TrackResult result = impactdic::track(request, session);
  Errors errors;
  for (const TrackRow& row : result.rows) errors.add(row, clip);
  return errors;
}

TEST(TextureTrack, ASphereBeforeWood) {
  const Errors errors =
      tracked(Rendered(before(Backdrop::kWood, true), 1, 12), Body::kSphere, true);
  EXPECT_GE(errors.circles, 11);
  EXPECT_GE(errors.motions, 10);
  EXPECT_EQ(errors.wrong, 0);
  EXPECT_LT(errors.rms_px(), 0.15);
  EXPECT_LT(errors.over_sd(), 2);
}

TEST(TextureTrack, ADiscBeforeTiles) {
  const Errors errors = tracked(Rendered(before(Backdrop::kTiles, false), 2, 8), Body::kDisc, true);
  EXPECT_GE(errors.circles, 8);
  EXPECT_GE(errors.motions, 7);
  EXPECT_EQ(errors.wrong, 0);
  EXPECT_LT(errors.rms_px(), 0.15);
  EXPECT_LT(errors.over_sd(), 2);
}

// The light behind it goes out after the first frames.
TEST(TextureTrack, AStreamDoesNotKeepTheBackgroundOfItsFirstFrames) {
  constexpr int kBeforeWood = 12, kFrames = 15;
  Rendered clip(before(Backdrop::kWood, true), 1, kFrames, 0, kBeforeWood);
  const Rendered even(before(Backdrop::kEven, true), 1, kFrames, kBeforeWood, kFrames);
  for (std::size_t k = kBeforeWood; k < kFrames; ++k) clip.frames[k] = even.frames[k];
  LiveRequest request;
  request.stream = std::make_shared<Stream>(clip);
  request.track.clip.fps = 1000;
  request.track.with_field = false;
  request.look = kBeforeWood;
  request.lag_s = 0;
  Session session;
  Errors errors;
  track_live(request, session, {}, [&](const LiveRow& row) {
    if (row.row.frame >= kBeforeWood) errors.add(row.row, clip);
  });
  EXPECT_EQ(errors.circles, kFrames - kBeforeWood);
  EXPECT_EQ(errors.wrong, 0);
  EXPECT_LT(errors.rms_px(), 0.05);
}

}  // namespace
}  // namespace impactdic::testing
