// Which frames a film lacks by the way that the ball goes, and how rows count them.
#include "host/run/metres/lost_frames.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace impactdic::run {
namespace {

constexpr std::size_t kGap = 8;
constexpr double kFps = 10000;

// Of a ball that goes `step_px` a frame, give or take `scatter_px`, and so many times as far behind
// one of them; steps state `sd_px`.
std::vector<TrackRow> rows_of(double step_px, double times, double scatter_px, double sd_px) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, scatter_px);
  std::vector<TrackRow> rows(20);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TrackRow& row = rows[i];
    row.frame = static_cast<std::int64_t>(i);
    row.time_s = static_cast<double>(i) / kFps;
    row.status = TrackStatus::kOk;
    row.circle_ok = row.motion_ok = true;
    row.r_px = 50;
    row.dx_px = step_px * (i == kGap ? times : 1) + noise(random);
    row.dy_px = noise(random);
    row.rot_deg = row.rot_sd_deg = 0;
    row.dx_sd_px = row.dy_sd_px = sd_px;
  }
  return rows;
}

int missing(double step_px, double times, double scatter_px, double sd_px) {
  const std::vector<TrackRow> rows = rows_of(step_px, times, scatter_px, sd_px);
  int count = 0;
  for (const MissingFrames& gap : missing_frames(rows)) {
    EXPECT_EQ(gap.behind, kGap);
    count += gap.count;
  }
  return count;
}

TEST(LostFrames, AreAsManyAsTheStepHolds) {
  EXPECT_EQ(missing(0.7, 2, 0.002, 0.002), 1);
  EXPECT_EQ(missing(0.7, 4, 0.002, 0.002), 3);
  EXPECT_EQ(missing(0.7, 1, 0.002, 0.002), 0);
  EXPECT_EQ(missing(0.7, 2.4, 0.002, 0.002), 0);
}

// What is stated may be alike in all steps, and they scatter by a part of it.
TEST(LostFrames, ByStepsThatScatterByLessThanTheyState) {
  EXPECT_EQ(missing(0.7, 2, 0.002, 0.05), 1);
  EXPECT_EQ(missing(0.7, 2, 0.04, 0.05), 0);
}

TEST(LostFrames, AreCounted) {
  std::vector<TrackRow> rows = rows_of(0.7, 3, 0.002, 0.002);
  const std::vector<MissingFrames> gaps = missing_frames(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) count(gaps, kFps, i, rows[i]);
  EXPECT_EQ(rows[kGap].periods, 3);
  EXPECT_EQ(rows[kGap + 1].periods, 1);
  EXPECT_DOUBLE_EQ(rows[kGap].time_s, kGap / kFps);
  EXPECT_DOUBLE_EQ(rows[kGap + 1].time_s, (kGap + 3) / kFps);
  EXPECT_TRUE(missing_frames(rows).empty());  // those that rows count are told
}

}  // namespace
}  // namespace impactdic::run
