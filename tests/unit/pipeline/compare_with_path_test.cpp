// Motions and circles that lead apart over some frames, and who is to blame.
#include "host/pipeline/rows/compare_with_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <random>
#include <vector>

namespace impactdic::testing {
namespace {

// Frames of a ball that moves by 0.31 px, as circles and motions have it.
std::vector<TrackRow> steady_rows(std::size_t count, double motion_off_px, double circle_sd_px) {
  std::vector<TrackRow> rows(count);
  for (std::size_t i = 0; i < count; ++i) {
    TrackRow& row = rows[i];
    row.status = TrackStatus::kOk;
    row.circle_ok = row.motion_ok = true;
    row.cx_px = 50 + 0.31 * static_cast<double>(i);
    row.cy_px = 40;
    row.dx_px = 0.31 + motion_off_px;
    row.dy_px = 0;
    row.cx_sd_px = row.cy_sd_px = circle_sd_px;
    row.dx_sd_px = row.dy_sd_px = 0.002;
  }
  return rows;
}

std::vector<std::size_t> inconsistent(std::vector<TrackRow> rows) {
  pipeline::compare_with_path(rows);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].status == TrackStatus::kInconsistent) found.push_back(i);
  }
  return found;
}

TEST(CompareWithPath, MotionsThatLeadElsewhereAreInconsistent) {
  EXPECT_EQ(inconsistent(steady_rows(12, 0, 0.012)).size(), 0u);
  EXPECT_EQ(inconsistent(steady_rows(12, 0.03, 0.012)).size(), 11u);  // no row alone shows it
  EXPECT_EQ(inconsistent(steady_rows(60, 0.03, 0.012)).size(), 59u);
  EXPECT_EQ(inconsistent(steady_rows(12, 0.03, 0.1)).size(), 0u);    // by chance
  EXPECT_EQ(inconsistent(steady_rows(12, 0.01, 0.001)).size(), 0u);  // of no account
  std::vector<TrackRow> broken = steady_rows(12, 0.03, 0.012);
  for (const std::size_t i : {2, 5, 8}) broken[i].status = TrackStatus::kNoBall;
  EXPECT_EQ(inconsistent(broken).size(), 0u);  // over two frames it does not show either
}

// The same with circles that err by what they state.
TEST(CompareWithPath, MotionsThatErrAlikeAreBorneOutByNoCircles) {
  std::mt19937 random(2);
  std::normal_distribution<double> error(0, 0.012);
  std::vector<TrackRow> rows = steady_rows(60, 0.03, 0.012);
  for (TrackRow& row : rows) row.cx_px += error(random), row.cy_px += error(random);
  EXPECT_GT(inconsistent(rows).size(), 55u);
}

// Four wrong circles: what lies beside them is right.
TEST(CompareWithPath, AWrongCircleTakesNoneAlong) {
  std::vector<TrackRow> rows = steady_rows(60, 0, 0.012);
  for (std::size_t i = 30; i < 34; ++i) rows[i].cy_px += 0.5;
  EXPECT_EQ(inconsistent(rows), (std::vector<std::size_t>{29, 30, 31, 32, 33}));
}

// A shadow that is followed for twenty frames: nothing tells which of the two is the ball.
TEST(CompareWithPath, ARunOfWrongCirclesIsNotBorneOut) {
  std::vector<TrackRow> rows = steady_rows(60, 0, 0.012);
  for (std::size_t i = 20; i < 40; ++i) rows[i].cy_px += 0.5;
  const std::vector<std::size_t> found = inconsistent(rows);
  for (const std::size_t i : {16, 17, 18, 19, 20, 21, 22, 23, 36, 37, 38, 39, 40, 41, 42, 43}) {
    EXPECT_TRUE(std::find(found.begin(), found.end(), i) != found.end()) << i;
  }
}

}  // namespace
}  // namespace impactdic::testing
