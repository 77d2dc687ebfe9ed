// Turns that the pairs beside them do not bear out.
#include <gtest/gtest.h>

#include <cstddef>
#include <utility>
#include <vector>

#include "host/motion/measure_pairs.h"

namespace impactdic::motion {
namespace {

struct Turn {
  double x = 0, y = 0, z = 0;
  bool sought = false;
};

// Measures what it was told, pair by pair.
class Told : public MotionEstimator {
 public:
  explicit Told(std::vector<Turn> turns) : turns_(std::move(turns)) {}
  void measure(std::span<PairMotion> pairs) override {
    for (PairMotion& pair : pairs) {
      const Turn& turn = turns_[static_cast<std::size_t>(pair.first_slot)];
      pair.motion.ok = true;
      pair.motion.rot_x_rad = turn.x;
      pair.motion.rot_y_rad = turn.y;
      pair.motion.rot_rad = turn.z;
      pair.sought = turn.sought;
      pair.status = TrackStatus::kOk;
    }
  }
  std::span<const Window> grid() const override { return {}; }

 private:
  std::vector<Turn> turns_;
};

// Which of the turns are left.
std::vector<bool> left_of(const std::vector<Turn>& turns) {
  std::vector<PairMotion> pairs(turns.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].first_slot = static_cast<int>(i);
  Told told(turns);
  measure_pairs(told, 60, pairs);
  std::vector<bool> left;
  for (const PairMotion& pair : pairs) {
    left.push_back(pair.motion.ok);
    EXPECT_EQ(pair.motion.ok, pair.status == TrackStatus::kOk);
  }
  return left;
}

constexpr Turn kUsual{-0.04, 0.04, 0.02};

TEST(LoneTurns, OneThatNeitherSideBearsOutIsNone) {
  const std::vector<Turn> turns = {kUsual, kUsual, {0.05, -0.02, -0.03}, kUsual, kUsual};
  EXPECT_EQ(left_of(turns), (std::vector<bool>{true, true, false, true, true}));
}

// A picture may be lost, or be there twice.
TEST(LoneTurns, MultiplesOfTheUsualTurnStay) {
  const std::vector<Turn> turns = {kUsual, {-0.08, 0.08, 0.04}, kUsual, {0, 0, 0}, kUsual};
  EXPECT_EQ(left_of(turns), std::vector<bool>(5, true));
}

TEST(LoneTurns, AnImpactIsAStepThatStays) {
  const Turn after{0.02, -0.05, 0.06};
  EXPECT_EQ(left_of({kUsual, kUsual, {-0.01, 0, 0.04}, after, after}), std::vector<bool>(5, true));
}

// Even where only one side is known, and by a whole turn of the ball.
TEST(LoneTurns, OneThatWasSoughtEverywhereMustBeBorneOut) {
  const Turn wrong{0.4, 1.1, -2.8, true};
  EXPECT_EQ(left_of({wrong, kUsual, kUsual}), (std::vector<bool>{false, true, true}));
  const Turn right{-0.041, 0.039, 0.021, true};
  EXPECT_EQ(left_of({right, kUsual, kUsual}), std::vector<bool>(3, true));
}

}  // namespace
}  // namespace impactdic::motion
