// A ball that enters the picture: its speckles come first, and must not be taken for the ball.
#include "host/circle/scout_ball.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/circle/ball_tracker.h"
#include "host/circle/scene/backdrop.h"
#include "sim/speckle/render.h"

namespace impactdic {
namespace {

constexpr double kRadius = 60;

class PictureList : public FrameSource {
 public:
  explicit PictureList(std::vector<Frame> frames) : frames_(std::move(frames)) {
    info_.width = frames_[0].width();
    info_.height = frames_[0].height();
    info_.frame_count = static_cast<std::int64_t>(frames_.size());
  }
  const ClipInfo& info() const override { return info_; }
  void read(std::int64_t index, Frame& frame) override {
    if (index == damaged) throw FileError("a damaged frame", "test");
    frame = frames_[static_cast<std::size_t>(index)];
  }
  FrameRange range() const { return {0, info_.frame_count, 1}; }
  Roi whole() const { return {0, 0, info_.width, info_.height}; }

  std::int64_t damaged = -1;

 private:
  ClipInfo info_;
  std::vector<Frame> frames_;
};

// 30 frames, 10 px a frame, from out of the picture at the left to out of it at the right.
BallPose pose_at(int frame) { return {-50.0 + 10.3 * frame, 110.2, 3.0 * frame}; }

PictureList entering_clip(const char* pattern) {
  SynthScene scene;
  scene.width = 200;
  scene.height = 220;
  scene.noise_sigma = 2;
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball(pattern, 3, kRadius), scene);
  std::vector<Frame> frames(30);
  for (int i = 0; i < 30; ++i) renderer.render(pose_at(i), i, frames[static_cast<std::size_t>(i)]);
  return PictureList(std::move(frames));
}

TEST(ScoutBall, SpecklesThatEnterFirstAreNotTheBall) {
  for (const char* pattern : {"f1", "e1"}) {
    PictureList clip = entering_clip(pattern);
    const auto radius = circle::scout_ball(clip, clip.range(), clip.whole(), {}).radius_px();
    ASSERT_TRUE(radius) << pattern;
    EXPECT_NEAR(*radius, kRadius, 0.1) << pattern;

    circle::BallTracker tracker({.scouted_radius_px = radius});
    int measured = 0;
    for (int i = 0; i < 30; ++i) {
      Frame frame;
      clip.read(i, frame);
      const circle::CircleFit fit = tracker.track(frame, i);
      if (fit.status != circle::CircleStatus::kOk) continue;
      ++measured;
      const BallPose truth = pose_at(i);
      EXPECT_LT(std::hypot(fit.circle.cx_px - truth.cx_px, fit.circle.cy_px - truth.cy_px), 0.2)
          << pattern << ", frame " << i;
    }
    EXPECT_GE(measured, 18) << pattern;  // all whose centre lies in the picture, but for one
  }
}

// The one that moves was called the second ball, since it is never far from the one that rests.
TEST(ScoutBall, ABallThatMovesComesBeforeOneThatRests) {
  const auto candidate = [](double moved_px, double score) {
    circle::BallCandidate ball{.radius_px = 30, .moved_px = moved_px, .rim_fraction = 0.55};
    ball.score = score;
    ball.sightings.resize(12);
    return ball;
  };
  const auto first_moves_by = [&](double best_px, double other_px, double other_score) {
    circle::Scouted scouted;
    scouted.frames = 12;
    scouted.balls = {candidate(best_px, 200), candidate(other_px, other_score)};
    scouted.put_mover_first();
    return scouted.balls.front().moved_px;
  };
  EXPECT_EQ(first_moves_by(0.1, 25, 190), 25);
  EXPECT_EQ(first_moves_by(0.1, 25, 50), 0.1);  // it shows too little of its rim
  EXPECT_EQ(first_moves_by(0.1, 2, 190), 0.1);  // it hardly moves
  EXPECT_EQ(first_moves_by(12, 25, 190), 12);   // both move
}

TEST(ScoutBall, LivesWithADamagedFrameAndAnEmptyClip) {
  PictureList clip = entering_clip("f1");
  clip.damaged = 12;
  EXPECT_TRUE(circle::scout_ball(clip, clip.range(), clip.whole(), {}).radius_px());

  Frame grey;
  clip.read(0, grey);
  PictureList empty(std::vector<Frame>(5, grey));
  EXPECT_FALSE(circle::scout_ball(empty, empty.range(), empty.whole(), {}).radius_px());
}

// Down and up again by less than the ball's width, so that much of the wall is never seen.
BallPose bounce_at(int frame) {
  const double fall = frame < 20 ? 2.2 * frame : 44 - 1.6 * (frame - 20);
  return {150 + 1.1 * frame, 110.2 + fall, 0.4 * frame};
}

// Before graph paper: squares of 12 px, whose lines are as dark as the ball's ink and which are
// about as bright as its paint. `moves_px`: of the paper, from frame to frame.
PictureList clip_before_paper(const char* pattern, double moves_px) {
  SynthScene scene;
  scene.width = 340;
  scene.height = 280;
  scene.noise_sigma = 2;
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball(pattern, 3, kRadius), scene);
  std::vector<Frame> frames(40);
  for (int k = 0; k < 40; ++k) {
    Frame& frame = frames[static_cast<std::size_t>(k)];
    const BallPose pose = bounce_at(k);
    renderer.render(pose, k, frame);
    for (int y = 0; y < scene.height; ++y) {
      for (int x = 0; x < scene.width; ++x) {
        const double behind =
            std::clamp(std::hypot(x - pose.cx_px, y - pose.cy_px) - kRadius + 0.5, 0.0, 1.0);
        const double along = std::abs(std::fmod(x + moves_px * k, 12.0) - 6);
        const double down = std::abs(std::fmod(y, 12.0) - 6);
        const bool line = std::min(along, down) < 0.8;
        const double paper = line ? 0 : 130;  // more than the scene's background
        frame.u8(x, y) = static_cast<std::uint8_t>(std::lround(frame.u8(x, y) + behind * paper));
      }
    }
  }
  return PictureList(std::move(frames));
}

// No ball was found, or one of its marks, or an arc of it, many pixels off.
TEST(ScoutBall, GraphPaperBehindTheBallIsLearnt) {
  for (const char* pattern : {"a2", "d1", "e1"}) {
    PictureList clip = clip_before_paper(pattern, 0);
    const circle::Scouted scouted = circle::scout_ball(clip, clip.range(), clip.whole(), {});
    ASSERT_TRUE(scouted.radius_px()) << pattern;
    EXPECT_NEAR(*scouted.radius_px(), kRadius, 1) << pattern;
    ASSERT_NE(scouted.backdrop, nullptr) << pattern;

    circle::BallTracker tracker({.scouted_radius_px = scouted.radius_px(),
                                 .scene = scouted.scene,
                                 .backdrop = scouted.backdrop});
    int measured = 0;
    for (int k = 0; k < 40; ++k) {
      Frame frame;
      clip.read(k, frame);
      const circle::CircleFit fit = tracker.track(frame, k);
      if (fit.status != circle::CircleStatus::kOk) continue;
      ++measured;
      const BallPose truth = bounce_at(k);
      EXPECT_LT(std::hypot(fit.circle.cx_px - truth.cx_px, fit.circle.cy_px - truth.cy_px),
                5 * std::hypot(fit.cx_sd_px, fit.cy_sd_px))
          << pattern << ", frame " << k;
    }
    EXPECT_GE(measured, 27) << pattern;
  }
}

TEST(ScoutBall, PaperThatMovesIsNoBackdrop) {
  for (const double moves_px : {0.0, 0.4}) {
    PictureList clip = clip_before_paper("e1", moves_px);
    std::vector<Frame> frames(10);
    std::vector<circle::Backdrop::View> views;
    for (int k = 0; k < 10; ++k) {
      Frame& frame = frames[static_cast<std::size_t>(k)];
      clip.read(2 * k, frame);
      const BallPose ball = bounce_at(2 * k);
      views.push_back({&frame, {{{ball.cx_px, ball.cy_px, kRadius}}}});
    }
    const auto learnt = circle::Backdrop::learn(views, circle::Backdrop::Known::kWell);
    EXPECT_EQ(learnt != nullptr, moves_px == 0) << moves_px;
  }
}

}  // namespace
}  // namespace impactdic
