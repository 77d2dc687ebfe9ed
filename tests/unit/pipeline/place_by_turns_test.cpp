// Centres of a sphere by what its turns tell, carried on by its motions.
#include "host/pipeline/rows/place_by_turns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "host/sphere/source_response.h"

namespace impactdic::testing {
namespace {

constexpr std::size_t kFrames = 16;
constexpr double kRadius = 60, kOff_x = 0.12, kOff_y = -0.07, kCircle_px = 0.09, kMotion_px = 0.002;
constexpr double kTurn_x = 0.012, kTurn_y = -0.02, kTurn_z = 0.09;

double true_x(std::size_t i) { return 80 + 0.9 * static_cast<double>(i); }
double true_y(std::size_t i) { return 70 - 0.4 * static_cast<double>(i); }

// A sphere whose circles are all off by as much, as under a lamp, so that its motions are about
// another point.
struct Clip {
  std::vector<TrackRow> rows = std::vector<TrackRow>(kFrames);
  std::vector<motion::PairMotion> pairs = std::vector<motion::PairMotion>(kFrames);
  motion::EstimatorOptions options;

  Clip() {
    options.sphere = true;
    options.sphere_radius_px = kRadius;
    const auto by = sphere::source_response({{kTurn_x, kTurn_y, kTurn_z}, kRadius, {}, {}, {}});
    for (std::size_t i = 0; i < kFrames; ++i) {
      TrackRow& row = rows[i];
      row.status = TrackStatus::kOk;
      row.circle_ok = true;
      row.r_px = kRadius;
      row.cx_px = true_x(i) + kOff_x;
      row.cy_px = true_y(i) + kOff_y;
      row.cx_sd_px = row.cy_sd_px = kCircle_px;
      dic::RigidMotion& motion = pairs[i].motion;
      motion.ok = i + 1 < kFrames;
      motion.dx_px = 0.9 + by.dx[0] * kOff_x + by.dx[1] * kOff_y;
      motion.dy_px = -0.4 + by.dy[0] * kOff_x + by.dy[1] * kOff_y;
      motion.rot_x_rad = kTurn_x + by.rot_x[0] * kOff_x + by.rot_x[1] * kOff_y;
      motion.rot_y_rad = kTurn_y + by.rot_y[0] * kOff_x + by.rot_y[1] * kOff_y;
      motion.rot_rad = kTurn_z + by.rot_z[0] * kOff_x + by.rot_z[1] * kOff_y;
      motion.dx_sd_px = motion.dy_sd_px = kMotion_px;
      motion.rot_x_sd_rad = motion.rot_y_sd_rad = motion.rot_sd_rad = 1e-5;
    }
  }
  void place(const std::vector<motion::TurnedCentre>& told) {
    pipeline::place_by_turns(rows, pairs, told, options);
  }
  bool stays() const {
    const Clip before;
    for (std::size_t i = 0; i < kFrames; ++i) {
      if (rows[i].cx_px != before.rows[i].cx_px || rows[i].cy_px != before.rows[i].cy_px ||
          rows[i].cx_sd_px != kCircle_px || pairs[i].motion.dx_px != before.pairs[i].motion.dx_px) {
        return false;
      }
    }
    return true;
  }
};

motion::TurnedCentre told(std::size_t frame, double more_px = 0, double sd_px = 0.01) {
  return {frame, kOff_x + more_px, kOff_y + more_px, sd_px, sd_px};
}

TEST(PlaceByTurns, WhatTwoFramesTellAllRowsTakeUp) {
  Clip clip;
  clip.place({told(2), told(9)});
  for (std::size_t i = 0; i < kFrames; ++i) {
    const TrackRow& row = clip.rows[i];
    EXPECT_EQ(row.status, TrackStatus::kOk);
    // The circle keeps its part.
    EXPECT_NEAR(row.cx_px, true_x(i), 0.006) << i;
    EXPECT_NEAR(row.cy_px, true_y(i), 0.006) << i;
    EXPECT_LT(row.cx_sd_px, 0.02);
    EXPECT_GT(row.cx_sd_px, 0.006);
    // The rim stays where it was.
    EXPECT_NEAR(row.cx_px + row.rim_off_x_px, true_x(i) + kOff_x, 1e-12);
    EXPECT_NEAR(row.cy_px + row.rim_off_y_px, true_y(i) + kOff_y, 1e-12);
    EXPECT_EQ(row.rim_x_sd_px, kCircle_px);
    EXPECT_EQ(row.rim_y_sd_px, kCircle_px);
    if (i + 1 == kFrames) continue;
    const dic::RigidMotion& motion = clip.pairs[i].motion;
    EXPECT_NEAR(motion.dx_px, 0.9, 5e-4);
    EXPECT_NEAR(motion.dy_px, -0.4, 5e-4);
    EXPECT_NEAR(motion.rot_x_rad, kTurn_x, 2e-6);
    EXPECT_NEAR(motion.rot_y_rad, kTurn_y, 2e-6);
  }
  EXPECT_GT(clip.rows[15].cx_sd_px, clip.rows[9].cx_sd_px);  // the way there
}

TEST(PlaceByTurns, OneFrameOrFramesThatDisagreeTellNothing) {
  for (const std::vector<motion::TurnedCentre>& given :
       {std::vector{told(2)}, std::vector{told(2), told(9, 0.2)},
        std::vector{told(2, 0, 0.3), told(9, 0, 0.3)}, std::vector<motion::TurnedCentre>{}}) {
    Clip clip;
    clip.place(given);
    EXPECT_TRUE(clip.stays()) << given.size();
    EXPECT_TRUE(std::isnan(clip.rows[3].rim_off_x_px));
    EXPECT_EQ(clip.rows[3].status, TrackStatus::kOk);
  }
}

TEST(PlaceByTurns, WhatTheFramesTellApartIsStated) {
  Clip agreed, apart;
  agreed.place({told(2), told(9)});
  apart.place({told(2), told(9, 0.035)});
  const auto stated = [](const TrackRow& row) { return std::hypot(row.cx_sd_px, row.cy_sd_px); };
  EXPECT_GT(stated(apart.rows[5]), 1.4 * stated(agreed.rows[5]));
}

TEST(PlaceByTurns, ACircleThatContradictsThemIsInconsistent) {
  Clip clip;
  for (TrackRow& row : clip.rows) row.cx_sd_px = row.cy_sd_px = 0.01;
  clip.place({told(2), told(9)});
  for (std::size_t i = 0; i < kFrames; ++i) {
    EXPECT_EQ(clip.rows[i].status, TrackStatus::kInconsistent);
    EXPECT_EQ(clip.rows[i].cx_px, true_x(i) + kOff_x);
  }
}

TEST(PlaceByTurns, NeitherACorrectedCircleNorOneBehindACompressedBallIsPlaced) {
  Clip clip;
  clip.rows[4].by_hand = ByHand::kGuided;
  clip.rows[10].e1_px = clip.rows[10].e2_px = 1;
  clip.place({told(1), told(6)});
  EXPECT_EQ(clip.rows[4].cx_px, true_x(4) + kOff_x);
  EXPECT_NEAR(clip.rows[9].cx_px, true_x(9), 0.006);
  for (std::size_t i = 10; i < kFrames; ++i) {
    EXPECT_EQ(clip.rows[i].cx_px, true_x(i) + kOff_x) << i;
  }
}

// Of a turn by a third of a circle too little is seen to tell what a centre does to it.
TEST(PlaceByTurns, NothingIsCarriedOverATurnThatHidesWhatWasSeen) {
  Clip clip;
  dic::RigidMotion& motion = clip.pairs[7].motion;
  motion.rot_y_rad = 2.1;
  clip.place({told(1), told(5)});
  EXPECT_NEAR(clip.rows[7].cx_px, true_x(7), 0.006);
  EXPECT_EQ(motion.rot_y_rad, 2.1);
  for (std::size_t i = 8; i < kFrames; ++i) EXPECT_EQ(clip.rows[i].cx_px, true_x(i) + kOff_x) << i;
}

}  // namespace
}  // namespace impactdic::testing
