// Motions that lead slowly elsewhere than the circles do.
#include "host/pipeline/rows/doubt_motions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace impactdic::testing {
namespace {

constexpr std::size_t kFrames = 40;
constexpr double kSpeed_px = 0.5, kCircle_px = 0.012, kMotion_px = 0.002;

struct Path {
  std::vector<TrackRow> rows{kFrames};
  std::vector<motion::PairMotion> pairs{kFrames};
};

// A ball that flies to the right; its motions are slower by a share, its circles drift.
Path flight(double slowed, double drift_px, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Path path;
  for (std::size_t i = 0; i < kFrames; ++i) {
    TrackRow& row = path.rows[i];
    row.status = TrackStatus::kOk;
    row.circle_ok = row.motion_ok = true;
    row.cx_px = 50 + (kSpeed_px + drift_px) * static_cast<double>(i) + kCircle_px * normal(random);
    row.cy_px = 40 + kCircle_px * normal(random);
    row.cx_sd_px = row.cy_sd_px = kCircle_px;
    dic::RigidMotion& motion = path.pairs[i].motion;
    motion.ok = true;
    motion.dx_px = row.dx_px = (1 - slowed) * kSpeed_px + kMotion_px * normal(random);
    motion.dy_px = row.dy_px = kMotion_px * normal(random);
    motion.dx_sd_px = motion.dy_sd_px = row.dx_sd_px = row.dy_sd_px = kMotion_px;
  }
  return path;
}

// As columns of a sensor do that differ by some grey levels.
TEST(DoubtMotions, WhatSlowsThemAllIsStated) {
  Path path = flight(0.03, 0, 1);
  const std::vector<bool> doubted = pipeline::doubt_motions(path.rows, path.pairs);
  for (std::size_t i = 0; i + 1 < kFrames; ++i) {
    EXPECT_TRUE(doubted[i]) << i;
    EXPECT_NEAR(path.pairs[i].motion.dx_sd_px, 0.03 * kSpeed_px, 0.004) << i;
    EXPECT_EQ(path.pairs[i].motion.dy_sd_px, kMotion_px) << i;
  }
}

TEST(DoubtMotions, ChanceIsNone) {
  std::ptrdiff_t doubted = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    Path path = flight(0, 0, seed);
    const std::vector<bool> rows = pipeline::doubt_motions(path.rows, path.pairs);
    doubted += std::count(rows.begin(), rows.end(), true);
  }
  EXPECT_EQ(doubted, 0);
}

// What goes elsewhere by more than a tenth of the motion is no ball's circle.
TEST(DoubtMotions, CirclesOfSomethingElseDoubtNoMotion) {
  Path path = flight(0, 0.055, 2);
  const std::vector<bool> doubted = pipeline::doubt_motions(path.rows, path.pairs);
  EXPECT_EQ(std::count(doubted.begin(), doubted.end(), true), 0);
}

TEST(DoubtMotions, OneThatItsCirclesDoNotBearOutStatesByHowMuch) {
  Path path = flight(0, 0, 4);
  for (TrackRow& row : path.rows) row.cy_sd_px = 0.003, row.cy_px = 40;
  path.rows[20].dy_px = path.pairs[20].motion.dy_px = 0.06;
  const std::vector<bool> doubted = pipeline::doubt_motions(path.rows, path.pairs);
  EXPECT_EQ(std::count(doubted.begin(), doubted.end(), true), 1);
  EXPECT_TRUE(doubted[20]);
  EXPECT_NEAR(path.pairs[20].motion.dy_sd_px, 0.06, 0.001);
  // A circle that jumps away is another thing's.
  Path jump = flight(0, 0, 4);
  for (std::size_t i = 21; i < kFrames; ++i) jump.rows[i].cy_px += 0.5;
  pipeline::doubt_motions(jump.rows, jump.pairs);
  EXPECT_EQ(jump.pairs[20].motion.dy_sd_px, kMotion_px);
}

TEST(DoubtMotions, AFewFramesTellNothing) {
  Path path = flight(0.05, 0, 3);
  path.rows.resize(12);
  path.pairs.resize(12);
  const std::vector<bool> doubted = pipeline::doubt_motions(path.rows, path.pairs);
  EXPECT_EQ(std::count(doubted.begin(), doubted.end(), true), 0);
}

}  // namespace
}  // namespace impactdic::testing
