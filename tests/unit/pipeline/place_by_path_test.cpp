// Centres from the circles and motions of frames beside them.
#include "host/pipeline/rows/place_by_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

namespace impactdic::testing {
namespace {

constexpr std::size_t kFrames = 24, kContact = 10, kFree = 14;
constexpr double kTurn_rad = 0.04, kStrain = 0.03, kCircle_px = 0.01, kMotion_px = 0.0005;

bool is_in_contact(std::size_t i) { return i >= kContact && i < kFree; }
double true_x(std::size_t i) { return 50 + 0.7 * static_cast<double>(i); }
double true_y(std::size_t i) { return 40 - 0.2 * static_cast<double>(i); }

const std::vector<bool> kNowhereElse(kFrames);

struct Path {
  std::vector<TrackRow> rows;
  std::vector<motion::PairMotion> pairs;
};

// A flat ball that turns and, in contact, is stretched; there its circles are off by `off_px`. The
// motions are of the point that a circle takes for the centre, which turns about the true one.
Path contact(double off_px, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Path path;
  path.rows.resize(kFrames);
  path.pairs.resize(kFrames);
  for (std::size_t i = 0; i < kFrames; ++i) {
    const double sd_px = is_in_contact(i) ? off_px : kCircle_px;
    const double x = sd_px * normal(random), y = sd_px * normal(random);
    TrackRow& row = path.rows[i];
    row.status = TrackStatus::kOk;
    row.circle_ok = row.motion_ok = true;
    row.cx_px = true_x(i) + x, row.cy_px = true_y(i) + y;
    row.cx_sd_px = row.cy_sd_px = sd_px;
    motion::PairMotion& pair = path.pairs[i];
    if (is_in_contact(i)) pair.stretch = {kStrain, 0, -kStrain};
    const double xx = 1 + pair.stretch.xx, yy = 1 + pair.stretch.yy;
    const double c = std::cos(kTurn_rad), s = std::sin(kTurn_rad);
    dic::RigidMotion& motion = pair.motion;
    motion.ok = true;
    motion.rot_rad = kTurn_rad;
    motion.dx_px = 0.7 + (c * xx - 1) * x + s * yy * y + kMotion_px * normal(random);
    motion.dy_px = -0.2 - s * xx * x + (c * yy - 1) * y + kMotion_px * normal(random);
    motion.dx_sd_px = motion.dy_sd_px = kMotion_px;
  }
  return path;
}

TEST(PlaceByPath, WhatAContactHidesTheFramesBesideItTell) {
  double centre = 0, over_sd = 0, worst_px = 0;
  int count = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Path path = contact(0.5, seed);
    const std::vector<TrackRow> before = path.rows;
    const std::vector<bool> placed = pipeline::place_by_path(path.rows, path.pairs, kNowhereElse);
    for (std::size_t i = 0; i < kFrames; ++i) {
      const TrackRow& row = path.rows[i];
      EXPECT_EQ(placed[i], is_in_contact(i)) << i;
      if (!is_in_contact(i)) {
        EXPECT_EQ(row.cx_px, before[i].cx_px);
        EXPECT_EQ(row.cy_sd_px, before[i].cy_sd_px);
        continue;
      }
      const double x = row.cx_px - true_x(i), y = row.cy_px - true_y(i);
      centre += x * x + y * y;
      over_sd += std::pow(x / row.cx_sd_px, 2) + std::pow(y / row.cy_sd_px, 2);
      count += 2;
      // The motion is the placed centre's: it is off by what that turns, no more by what half a
      // pixel does (0.02 px).
      worst_px = std::fmax(worst_px, std::abs(path.pairs[i].motion.dx_px - 0.7));
      worst_px = std::fmax(worst_px, std::abs(path.pairs[i].motion.dy_px + 0.2));
    }
  }
  EXPECT_LT(std::sqrt(centre / count), kCircle_px);
  EXPECT_LT(std::sqrt(over_sd / count), 1.1);
  EXPECT_LT(worst_px, 4 * kMotion_px);
}

TEST(PlaceByPath, WhatIsAsExactAsTheOthersStays) {
  Path path = contact(kCircle_px, 3);
  const std::vector<bool> placed = pipeline::place_by_path(path.rows, path.pairs, kNowhereElse);
  for (const bool row : placed) EXPECT_FALSE(row);
}

// No motion leads across: neither side may tell of the other.
TEST(PlaceByPath, NothingIsCarriedByAMotionThatIsNotSure) {
  Path path = contact(0.5, 5);
  for (const std::size_t i : {kContact - 1, kFree - 1}) {
    path.rows[i].status = TrackStatus::kInconsistent;
  }
  const std::vector<bool> placed = pipeline::place_by_path(path.rows, path.pairs, kNowhereElse);
  for (const bool row : placed) EXPECT_FALSE(row);
}

// As through a lens that is not known: by a little more in every frame than circles go.
TEST(PlaceByPath, NothingIsCarriedByMotionsThatLeadElsewhere) {
  Path path = contact(0.5, 7);
  for (motion::PairMotion& pair : path.pairs) pair.motion.dx_px += kCircle_px;
  const std::vector<TrackRow> before = path.rows;
  pipeline::place_by_path(path.rows, path.pairs, kNowhereElse);
  for (std::size_t i = 0; i < kFrames; ++i) EXPECT_EQ(path.rows[i].cx_px, before[i].cx_px) << i;
}

// A circle of another thing, that is as sure of itself as the others, drags none along.
TEST(PlaceByPath, ACircleElsewhereOnTheBodyPlacesNoOther) {
  Path path = contact(0.5, 9);
  const std::size_t wrong = kFree;
  path.rows[wrong].cx_px += 3;  // its motion is that of the point there
  path.pairs[wrong].motion.dx_px += 3 * (std::cos(kTurn_rad) - 1);
  path.pairs[wrong].motion.dy_px -= 3 * std::sin(kTurn_rad);
  std::vector<bool> elsewhere(kFrames);
  elsewhere[wrong] = true;
  const std::vector<bool> placed = pipeline::place_by_path(path.rows, path.pairs, elsewhere);
  for (std::size_t i = kContact; i < kFree; ++i) {
    EXPECT_TRUE(placed[i]) << i;
    EXPECT_NEAR(path.rows[i].cx_px, true_x(i), 4 * kCircle_px) << i;
    EXPECT_LT(path.rows[i].cx_sd_px, 3 * kCircle_px) << i;
  }
}

}  // namespace
}  // namespace impactdic::testing
