// What the centres of frames that follow each other state.
#include "host/pipeline/rows/settle_centres.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace impactdic::testing {
namespace {

std::vector<TrackRow> rows_of(std::size_t count, double sd_px) {
  std::vector<TrackRow> rows(count);
  for (TrackRow& row : rows) {
    row.circle_ok = true;
    row.cx_sd_px = row.cy_sd_px = sd_px;
  }
  return rows;
}

std::vector<bool> settle(std::vector<TrackRow>& rows) {
  std::vector<motion::PairMotion> pairs(rows.size());
  return pipeline::settle_centres(rows, pairs, true, {});
}

// What one frame's residuals tell of a deviation is rough.
TEST(SettleCentres, ACircleIsHardlyBetterKnownThanThoseBesideIt) {
  std::vector<TrackRow> rows = rows_of(12, 0.04);
  rows[5].cx_sd_px = 0.01;
  rows[7].cx_sd_px = 0.036;  // by chance
  rows[9].cx_sd_px = 0.01;
  rows[9].by_hand = ByHand::kGuided;
  const std::vector<bool> changed = settle(rows);
  EXPECT_NEAR(rows[5].cx_sd_px, 0.02, 1e-9);
  EXPECT_EQ(rows[5].cy_sd_px, 0.04);
  EXPECT_EQ(rows[7].cx_sd_px, 0.036);
  EXPECT_EQ(rows[9].cx_sd_px, 0.01);  // somebody has looked at it
  EXPECT_EQ(std::count(changed.begin(), changed.end(), true), 1);
  EXPECT_TRUE(changed[5]);
}

// A bar from some frame on, or a frame without a ball between: others say nothing of those.
TEST(SettleCentres, WhatIsSeenOtherwiseStaysAsItIs) {
  std::vector<TrackRow> rows = rows_of(24, 0.01);
  for (std::size_t i = 12; i < rows.size(); ++i) rows[i].cx_sd_px = 0.1;
  settle(rows);
  EXPECT_EQ(rows[5].cx_sd_px, 0.01);
  EXPECT_EQ(rows[12].cx_sd_px, 0.1);
  std::vector<TrackRow> apart = rows_of(24, 0.01);
  for (std::size_t i = 12; i < apart.size(); ++i) apart[i].cx_sd_px = 0.1;
  apart[11].circle_ok = false;
  settle(apart);
  EXPECT_EQ(apart[10].cx_sd_px, 0.01);
}

}  // namespace
}  // namespace impactdic::testing
