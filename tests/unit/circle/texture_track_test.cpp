// Tracks of balls before wood and tiles, by the same run as a clip's file.
#include <gtest/gtest.h>
#include <impactdic/live/track_live.h>

#include <cstddef>
#include <memory>

#include "tests/support/tracks/light_tracks.h"

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

class Stream : public FrameStream {
 public:
  explicit Stream(const LightFilm& clip) : clip_(clip), info_(clip.info) { info_.frame_count = 0; }
  const ClipInfo& info() const override { return info_; }
  bool next(Frame& frame) override {
    if (next_ == clip_.frames.size()) return false;
    frame = clip_.frames[next_++];
    return true;
  }
  void stop() override {}

 private:
  const LightFilm& clip_;
  ClipInfo info_;
  std::size_t next_ = 0;
};

TEST(TextureTrack, ASphereBeforeWood) {
  const LightFilm clip(before(Backdrop::kWood, true), 1, 12);
  const LightErrors errors = errors_of(track(clip), clip);
  EXPECT_GE(errors.circles, 11);
  EXPECT_GE(errors.motions, 10);
  EXPECT_EQ(errors.wrong, 0);
  EXPECT_LT(errors.centre.rms(), 0.15);
  EXPECT_LT(errors.centre.over_sds(), 2);
}

TEST(TextureTrack, ADiscBeforeTiles) {
  const LightFilm clip(before(Backdrop::kTiles, false), 2, 8);
  const LightErrors errors = errors_of(track(clip), clip);
  EXPECT_GE(errors.circles, 8);
  EXPECT_GE(errors.motions, 7);
  EXPECT_EQ(errors.wrong, 0);
  EXPECT_LT(errors.centre.rms(), 0.15);
  EXPECT_LT(errors.centre.over_sds(), 2);
}

// The light behind it goes out after the first frames.
TEST(TextureTrack, AStreamDoesNotKeepTheBackgroundOfItsFirstFrames) {
  constexpr int kBeforeWood = 12, kFrames = 15;
  LightFilm clip(before(Backdrop::kWood, true), 1, kFrames, 0, kBeforeWood);
  const LightFilm even(before(Backdrop::kEven, true), 1, kFrames, kBeforeWood, kFrames);
  for (std::size_t k = kBeforeWood; k < kFrames; ++k) clip.frames[k] = even.frames[k];
  LiveRequest request;
  request.stream = std::make_shared<Stream>(clip);
  request.track.clip.fps = 1000;
  request.track.with_field = false;
  request.look = kBeforeWood;
  request.lag_s = 0;
  Session session;
  LightErrors errors;
  track_live(request, session, {}, [&](const LiveRow& row) {
    if (row.row.frame >= kBeforeWood) errors.add(row.row, clip);
  });
  EXPECT_EQ(errors.circles, kFrames - kBeforeWood);
  EXPECT_EQ(errors.wrong, 0);
  EXPECT_LT(errors.centre.rms(), 0.05);
}

}  // namespace
}  // namespace impactdic::testing
