// Frames corrected by hand: how they are written, and how the ball is followed from them.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <cmath>
#include <vector>

#include "host/circle/ball_tracker.h"
#include "host/clip/ball_by_hand.h"
#include "host/clip/roi.h"
#include "sim/speckle/render.h"

namespace impactdic {
namespace {

using circle::CircleFit;
using circle::CircleStatus;

TEST(BallAt, ReadsBackInOrder) {
  const auto balls = read_balls_by_hand("12:none/3:230.5,180.25,60");
  const std::vector<BallByHand> wanted = {{3, 230.5, 180.25, 60}, {12, 0, 0, 0}};
  EXPECT_EQ(balls, wanted);
  EXPECT_EQ(to_text(balls), "3:230.5,180.25,60/12:none");
}

TEST(BallAt, RefusesWhatIsNoCorrection) {
  for (const char* text :
       {"", "3", "3:", "3:1,2", "3:1,2,3,4", "3:1,2,0", "3:1,2,2.9", "3:1,2,-9", "-1:none",
        "x:none", "3:nan,2,9", "3:none/3:none", "3:none/", "3:None"}) {
    EXPECT_THROW(read_balls_by_hand(text), InvalidArgument) << text;
  }
  ClipInfo clip;
  clip.width = 100, clip.height = 80, clip.frame_count = 10;
  EXPECT_NO_THROW(check_balls_by_hand({{9, 99, 79, 20}}, clip));
  EXPECT_THROW(check_balls_by_hand({{10, 50, 40, 20}}, clip), InvalidArgument);
  EXPECT_THROW(check_balls_by_hand({{9, 50, 80, 20}}, clip), InvalidArgument);
}

TEST(BallAt, IsCountedAsTheFramesThatAreAnalysed) {
  const auto analysed = as_analysed({{3, 50, 40, 20}, {4, 0, 0, 0}, {7, 60, 45, 20}, {9, 0, 0, 0}},
                                    {3, 9, 2}, {10, 20, 80, 60});
  const std::vector<BallByHand> wanted = {{0, 40, 20, 20}, {2, 50, 25, 20}};
  EXPECT_EQ(analysed, wanted);
}

TEST(BallAt, TellsTheFirstFrameOfWhichTwoDoNotSayTheSame) {
  const std::vector<BallByHand> balls = {{3, 50, 40, 20}, {7, 0, 0, 0}};
  EXPECT_EQ(first_difference(balls, balls), std::nullopt);
  EXPECT_EQ(first_difference({}, balls), 3);
  EXPECT_EQ(first_difference(balls, {{3, 50, 40, 20}}), 7);
  EXPECT_EQ(first_difference(balls, {{3, 50, 40, 20}, {5, 0, 0, 0}, {7, 0, 0, 0}}), 5);
  EXPECT_EQ(first_difference({{3, 50, 40.5, 20}}, balls), 3);
}

TEST(BallAt, TellsTheRadiusOfAnotherBall) {
  EXPECT_EQ(radius_by_hand(40.0, {}), 40.0);
  EXPECT_EQ(radius_by_hand(40.0, {{3, 0, 0, 0}}), 40.0);
  EXPECT_EQ(radius_by_hand(40.0, {{3, 9, 9, 43}}), 40.0);  // known better than it is drawn
  EXPECT_EQ(radius_by_hand(40.0, {{3, 9, 9, 20}, {5, 9, 9, 21}, {6, 9, 9, 22}}), 21.0);
  EXPECT_EQ(radius_by_hand(std::nullopt, {{3, 9, 9, 20}}), 20.0);
}

constexpr int kWidth = 300, kHeight = 160, kFrames = 20;
constexpr double kLarge = 45, kSmall = 28;

BallPose large_at(int frame) { return {60.0 + 2.3 * frame, 90, 0}; }
BallPose small_at(int frame) { return {240.0 - 1.7 * frame, 40, 0}; }

sim::speckle::BallRenderer renderer_of(double radius) {
  SynthScene scene;
  scene.width = kWidth;
  scene.height = kHeight;
  return {sim::speckle::paint_ball("f1", 3, radius), scene};
}

// A large ball and a small one on their ways past each other.
const std::vector<Frame>& two_balls() {
  static const std::vector<Frame> frames = [] {
    const sim::speckle::BallRenderer large = renderer_of(kLarge), small = renderer_of(kSmall);
    std::vector<Frame> made;
    Frame other;
    for (int i = 0; i < kFrames; ++i) {
      Frame frame;
      large.render(large_at(i), 0, frame);
      small.render(small_at(i), 0, other);
      const std::uint8_t ground = other.u8(kWidth - 1, kHeight - 1);
      for (std::size_t k = 0; k < frame.u8.size(); ++k) {
        if (other.u8.data()[k] != ground) frame.u8.data()[k] = other.u8.data()[k];
      }
      made.push_back(std::move(frame));
    }
    return made;
  }();
  return frames;
}

std::vector<CircleFit> follow(const std::vector<Frame>& frames, std::vector<BallByHand> by_hand) {
  circle::BallTracker tracker({.by_hand = std::move(by_hand)});
  std::vector<CircleFit> fits(frames.size());
  tracker.follow(frames, 0, fits);
  return fits;
}

double off_px(const CircleFit& fit, const BallPose& pose) {
  return std::hypot(fit.circle.cx_px - pose.cx_px, fit.circle.cy_px - pose.cy_px);
}

TEST(ByHand, MeasuresFromTheCircleAndGoesOnWithThatBall) {
  const std::vector<CircleFit> alone = follow(two_balls(), {});
  const BallPose there = small_at(5);
  const std::vector<CircleFit> led =
      follow(two_balls(), {{5, there.cx_px + 1.5, there.cy_px - 1, kSmall + 1}});
  for (int i = 0; i < kFrames; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_LT(off_px(alone[k], large_at(i)), 0.1) << i;
    EXPECT_EQ(led[k].status, CircleStatus::kOk) << i;
    EXPECT_LT(off_px(led[k], i < 5 ? large_at(i) : small_at(i)), 0.1) << i;
    EXPECT_EQ(led[k].by_hand, i == 5 ? ByHand::kGuided : ByHand::kNo) << i;
  }
}

TEST(ByHand, ADrawnCircleStaysWhereNoRimIsFound) {
  std::vector<Frame> frames = two_balls();
  const std::uint8_t ground = frames[0].u8(kWidth - 1, kHeight - 1);
  std::fill(frames[7].u8.data(), frames[7].u8.data() + frames[7].u8.size(), ground);
  const BallPose there = large_at(7);
  const std::vector<CircleFit> fits =
      follow(frames, {{7, there.cx_px + 0.7, there.cy_px, kLarge - 1}});
  EXPECT_EQ(fits[7].by_hand, ByHand::kDrawn);
  EXPECT_EQ(fits[7].status, CircleStatus::kOk);
  EXPECT_EQ(fits[7].circle.cx_px, there.cx_px + 0.7);
  EXPECT_EQ(fits[7].circle.r_px, kLarge - 1);
  EXPECT_EQ(fits[7].cx_sd_px, 1);  // 2 % of the radius are less
  for (const int i : {6, 8, 9, 19}) {
    EXPECT_LT(off_px(fits[static_cast<std::size_t>(i)], large_at(i)), 0.1) << i;
    EXPECT_EQ(fits[static_cast<std::size_t>(i)].by_hand, ByHand::kNo);
  }
}

TEST(ByHand, AFrameSaidToHoldNoBallHoldsNone) {
  const std::vector<CircleFit> fits = follow(two_balls(), {{4, 0, 0, 0}, {16, 0, 0, 0}});
  for (const std::size_t i : {4u, 16u}) {
    EXPECT_EQ(fits[i].status, CircleStatus::kNoBall);
    EXPECT_EQ(fits[i].by_hand, ByHand::kAbsent);
  }
  for (const int i : {3, 5, 15, 17}) {
    EXPECT_LT(off_px(fits[static_cast<std::size_t>(i)], large_at(i)), 0.1) << i;
  }
}

TEST(Polygon, HoldsTheBallsCentre) {
  auto region = std::make_shared<Image<std::uint8_t>>(
      polygon_mask({{299, 60}, {299, 0}, {150, 0}, {150, 60}}, kWidth, kHeight));
  circle::BallTracker tracker({.circle = {.region = region}});
  std::vector<CircleFit> fits(two_balls().size());
  tracker.follow(two_balls(), 0, fits);
  for (int i = 0; i < kFrames; ++i) {
    const CircleFit& fit = fits[static_cast<std::size_t>(i)];
    EXPECT_EQ(fit.status, CircleStatus::kOk) << i;
    EXPECT_LT(off_px(fit, small_at(i)), 0.1) << i;
  }
}

}  // namespace
}  // namespace impactdic
