// Circles that lie elsewhere on the body than keyframes say.
#include "host/clip/centre_on_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <vector>

namespace impactdic::testing {
namespace {

// A ball of 60 px that flies and turns, its circles 0.1 px beside the body's place.
std::vector<TrackRow> flight(std::size_t count, bool sphere = false) {
  std::vector<TrackRow> rows(count);
  for (std::size_t i = 0; i < count; ++i) {
    TrackRow& row = rows[i];
    const auto frame = static_cast<double>(i);
    row.status = TrackStatus::kOk;
    row.circle_ok = row.motion_ok = row.pose.ok = true;
    row.pose.x_px = 100 + 0.7 * frame;
    row.pose.y_px = 200 - 0.2 * frame;
    row.pose.origin = 0;
    const double angle_rad = 0.05 * frame;
    if (!sphere) row.pose.angle_rad = angle_rad;
    // A turn against the clock, y down.
    row.cx_px = row.pose.x_px + 0.1 * (sphere ? 1 : std::cos(angle_rad));
    row.cy_px = row.pose.y_px - 0.1 * (sphere ? 0 : std::sin(angle_rad));
    row.r_px = 60;
    row.cx_sd_px = row.cy_sd_px = 0.01;
    row.dx_sd_px = row.dy_sd_px = 0.001;
  }
  return rows;
}

// How many of the rows, which follow those before, have their circle elsewhere.
std::size_t elsewhere(std::span<const TrackRow> rows, CentreOnBody& centre) {
  std::size_t count = 0;
  for (const TrackRow& row : rows) count += centre.compare(row).elsewhere ? 1 : 0;
  return count;
}
std::size_t elsewhere(std::span<const TrackRow> rows) {
  CentreOnBody centre;
  return elsewhere(rows, centre);
}

TEST(CentreOnBody, ABallThatTurnsIsWhereItIs) {
  for (const bool sphere : {false, true}) {
    CentreOnBody centre;
    EXPECT_EQ(elsewhere(flight(100, sphere), centre), 0u);
    EXPECT_NEAR(centre.x_px, 0.1, 1e-9);
    EXPECT_NEAR(centre.y_px, 0, 1e-9);
    EXPECT_EQ(centre.circles, 100);
  }
}

// All circles of a shadow agree with each other, and with the motions between them.
TEST(CentreOnBody, ARunOfCirclesIsElsewhere) {
  std::vector<TrackRow> rows = flight(100);
  for (std::size_t i = 40; i < 70; ++i) rows[i].cx_px += 0.9;
  CentreOnBody centre;
  EXPECT_EQ(elsewhere(std::span(rows).first(40), centre), 0u);
  EXPECT_EQ(elsewhere(std::span(rows).subspan(40, 30), centre), 30u);
  EXPECT_EQ(elsewhere(std::span(rows).subspan(70), centre), 0u);
}

// A hundredth of the radius, and half of what makes an ellipse of it.
TEST(CentreOnBody, AnOutlineNeedNotLieAboutTheCentre) {
  std::vector<TrackRow> rows = flight(100);
  for (std::size_t i = 40; i < 70; ++i) {
    rows[i].cx_px += 1.5;
    rows[i].e1_px = 0, rows[i].e2_px = 2;
  }
  CentreOnBody centre;
  EXPECT_EQ(elsewhere(rows, centre), 0u);
  EXPECT_NEAR(centre.x_px, 0.1, 1e-9);  // told by circles alone
  for (std::size_t i = 40; i < 70; ++i) rows[i].cx_px += 0.4;
  EXPECT_EQ(elsewhere(rows), 30u);
}

// Beyond chance, but not elsewhere: by so much, whichever way the ball has turned.
TEST(CentreOnBody, SaysHowFarACircleLiesBesideIt) {
  std::vector<TrackRow> rows = flight(60);
  for (std::size_t i = 40; i < 60; ++i) rows[i].cx_px += 0.3, rows[i].cy_px -= 0.1;
  CentreOnBody centre;
  for (std::size_t i = 0; i < 41; ++i) {
    const CentreOnBody::Beside beside = centre.compare(rows[i]);
    EXPECT_NEAR(beside.x_px, i < 40 ? 0 : 0.3, 1e-9) << i;
    EXPECT_NEAR(beside.y_px, i < 40 ? 0 : -0.1, 1e-9) << i;
    EXPECT_FALSE(beside.elsewhere) << i;
  }
}

// What is not known well contradicts nothing: motions that may all be off, a rough circle, few
// circles before, those of rows that contradict each other.
TEST(CentreOnBody, WhatIsInDoubtIsLeft) {
  std::vector<TrackRow> by_hand = flight(41);
  by_hand[40].cx_px += 0.9;
  EXPECT_EQ(elsewhere(by_hand), 1u);
  by_hand[40].by_hand = ByHand::kDrawn;
  EXPECT_EQ(elsewhere(by_hand), 0u);
  std::vector<TrackRow> doubted = flight(100), rough = flight(100), few = flight(5);
  for (TrackRow& row : doubted) row.dx_sd_px = row.dy_sd_px = 0.1;
  for (std::size_t i = 40; i < 100; ++i) {
    doubted[i].cx_px += 0.9;
    rough[i].cx_px += 0.9;
    rough[i].cx_sd_px = rough[i].cy_sd_px = 0.2;
  }
  few[4].cx_px += 0.9;
  std::vector<TrackRow> in_doubt = flight(100);
  for (std::size_t i = 0; i < 40; ++i) {
    in_doubt[i].status = TrackStatus::kInconsistent;
    in_doubt[i].cx_px += 0.9;
  }
  for (const auto& rows : {doubted, rough, few, in_doubt}) EXPECT_EQ(elsewhere(rows), 0u);
}

// A pattern on the sensor makes all motions err alike, and no circle tells the centre in contact.
TEST(CentreOnBody, MotionsThatErrAlikeMoveTheBody) {
  std::vector<TrackRow> rows = flight(200);
  for (std::size_t i = 0; i < 200; ++i) {
    rows[i].pose.x_px += 0.008 * static_cast<double>(i);
    rows[i].dx_sd_px = rows[i].dy_sd_px = 0.008;
    if (i >= 40 && i < 140) rows[i].e1_px = 1, rows[i].e2_px = 0;
  }
  EXPECT_EQ(elsewhere(rows), 0u);
}

// A ball that was lost may have been found elsewhere, and that says nothing of the others.
TEST(CentreOnBody, TheBodyAsItWasFoundFirstTells) {
  std::vector<TrackRow> rows = flight(100);
  for (std::size_t i = 40; i < 70; ++i) {
    rows[i].cx_px += 0.9;
    rows[i].pose.origin = 40;
  }
  EXPECT_EQ(elsewhere(rows), 0u);
  rows[80].cx_px += 0.9;
  EXPECT_EQ(elsewhere(rows), 1u);
}

}  // namespace
}  // namespace impactdic::testing
