// What circles and motions of frames that follow each other say of each other.
#include "host/pipeline/rows/compare_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace impactdic::testing {
namespace {

// A circle that steps otherwise than the ink on the ball is another thing, or the ink is.
TEST(CompareRows, ARowWhoseCircleAndInkGoApartSaysSo) {
  const auto status = [](double step_px, double sd_px) {
    TrackRow row, next;
    row.status = TrackStatus::kOk;
    row.circle_ok = row.motion_ok = next.circle_ok = true;
    row.cx_px = row.cy_px = next.cy_px = 100;
    next.cx_px = 100 + step_px;
    row.dx_px = 2, row.dy_px = 0;
    row.dx_sd_px = row.dy_sd_px = 0.001;
    for (TrackRow* at : {&row, &next}) at->cx_sd_px = at->cy_sd_px = sd_px;
    pipeline::compare_with_circles(row, next);
    return row.status;
  };
  EXPECT_EQ(status(2, 0.01), TrackStatus::kOk);
  EXPECT_EQ(status(18, 0.01), TrackStatus::kInconsistent);
  EXPECT_EQ(status(2.2, 0.01), TrackStatus::kInconsistent);
  EXPECT_EQ(status(2.2, 0.05), TrackStatus::kOk);    // by chance
  EXPECT_EQ(status(2.08, 0.001), TrackStatus::kOk);  // of no account
}

// Frames of a ball that moves by 0.31 px.
std::vector<TrackRow> steady_rows(double circle_sd_px) {
  std::vector<TrackRow> rows(12);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TrackRow& row = rows[i];
    row.status = TrackStatus::kOk;
    row.circle_ok = row.motion_ok = true;
    row.cx_px = 50 + 0.31 * static_cast<double>(i);
    row.cy_px = 40;
    row.dx_px = 0.31;
    row.dy_px = 0;
    row.cx_sd_px = row.cy_sd_px = circle_sd_px;
    row.dx_sd_px = row.dy_sd_px = 0.002;
  }
  return rows;
}

// Forty frames whose centres and radii err by so many of the deviations that they state.
std::vector<TrackRow> scattered_rows(double times, unsigned seed) {
  constexpr double kSd_px = 0.02;
  std::mt19937 random(seed);
  std::normal_distribution<double> error(0, times * kSd_px);
  std::vector<TrackRow> rows = steady_rows(kSd_px);
  rows.resize(40, rows.front());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TrackRow& row = rows[i];
    row.cx_px = 50 + 0.31 * static_cast<double>(i) + error(random);
    row.cy_px = 40 + error(random);
    row.r_px = 30 + error(random);
    row.r_sd_px = kSd_px;
  }
  return rows;
}

// Rms of errors over stated deviations, of both axes and of the radius.
struct OverStated {
  double centre = 0, radius = 0;
};
OverStated over_stated(double times) {
  double centre = 0, radius = 0;
  int count = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::vector<TrackRow> rows = scattered_rows(times, seed);
    pipeline::state_scatter(rows);
    for (std::size_t i = 0; i < rows.size(); ++i, ++count) {
      const TrackRow& row = rows[i];
      const double x = (row.cx_px - 50 - 0.31 * static_cast<double>(i)) / row.cx_sd_px;
      const double y = (row.cy_px - 40) / row.cy_sd_px, r = (row.r_px - 30) / row.r_sd_px;
      centre += (x * x + y * y) / 2;
      radius += r * r;
    }
  }
  return {std::sqrt(centre / count), std::sqrt(radius / count)};
}

TEST(CompareRows, CirclesStateWhatTheyScatterBy) {
  for (const double times : {1.0, 3.0, 10.0}) {
    const OverStated found = over_stated(times);
    EXPECT_GT(found.centre, 0.9) << times;
    EXPECT_LT(found.centre, 1.1) << times;
    EXPECT_GT(found.radius, 0.85) << times;
    EXPECT_LT(found.radius, 1.15) << times;
  }
}

TEST(CompareRows, ACircleThatLiesOffThePathAloneStatesIt) {
  std::vector<TrackRow> rows = scattered_rows(1, 7);
  const std::vector<TrackRow> before = rows;
  rows[5].cy_px += 0.6;
  rows[21].r_px -= 0.9;
  const std::vector<bool> changed = pipeline::state_scatter(rows);
  EXPECT_TRUE(changed[5]);
  EXPECT_NEAR(rows[5].cy_sd_px, 0.6, 0.05);
  EXPECT_NEAR(rows[21].r_sd_px, 0.9, 0.05);
  EXPECT_EQ(rows[5].cy_px, before[5].cy_px + 0.6);  // what was measured stays
  int others = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    others +=
        i != 5 && (rows[i].cx_sd_px > before[i].cx_sd_px || rows[i].cy_sd_px > before[i].cy_sd_px);
    others += i != 21 && rows[i].r_sd_px > before[i].r_sd_px;
  }
  EXPECT_LE(others, 2);
}

// Nothing of this is scatter: a ball that comes nearer, a sphere whose outline is not about its
// centre, a radius that compression changes, a motion that has nothing to do with the circle.
TEST(CompareRows, WhatChangesSteadilyIsNoScatter) {
  const auto changed = [](std::vector<TrackRow> rows, const auto& change) {
    for (std::size_t i = 0; i < rows.size(); ++i) change(rows[i], static_cast<double>(i));
    const std::vector<TrackRow> before = rows;
    const std::vector<bool> centres = pipeline::state_scatter(rows);
    auto count = std::count(centres.begin(), centres.end(), true);
    for (std::size_t i = 0; i < rows.size(); ++i) count += rows[i].r_sd_px > before[i].r_sd_px;
    return count;
  };
  const std::vector<TrackRow> rows = scattered_rows(1, 11);
  EXPECT_LE(changed(rows, [](TrackRow&, double) {}), 1);
  EXPECT_LE(changed(rows, [](TrackRow& row, double i) { row.r_px += 0.1 * i; }), 1);
  const auto near = [](TrackRow& row, double i) {
    row.rot_x_deg = row.rot_y_deg = 0;
    row.cx_px += 12.007 * i;
    row.dx_px += 12;
  };
  EXPECT_LE(changed(rows, near), 1);
  const auto contact = [](TrackRow& row, double i) {
    if (i < 15 || i >= 25) return;
    row.r_px -= 1.5;
    row.e1_px = 1.5, row.e2_px = 0;
  };
  EXPECT_LE(changed(rows, contact), 1);
  const auto few = [](TrackRow& row, double i) {
    row.cx_px += i;
    if (static_cast<int>(i) % 4 == 3) row.status = TrackStatus::kLowCorrelation;
  };
  EXPECT_LE(changed(rows, few), 1);  // four frames tell nothing
}

}  // namespace
}  // namespace impactdic::testing
