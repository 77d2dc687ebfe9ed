// A flat ball's flight by its places on keyframes, on rows made of an exact motion.
#include <gtest/gtest.h>
#include <impactdic/units.h>

#include <cmath>
#include <random>
#include <vector>

#include "host/impact/impact_phases.h"

namespace impactdic::testing {
namespace {

struct Flight {
  double vx = 0.31, vy = 0.17, spin_deg = 0.4;  // px and degrees a frame, y up
  // What its ink misplaces a circle by, turning along; of the point that is followed, likewise.
  double rim_px = 0.02, offset_px = 0.02;
  // Deviation of the circle that began the poses, where it is another one.
  double origin_sd_px = 0;
  double alike = 0;  // share of a step that something which stands still takes away
  int frames = 100;
  bool poses = true;
  double elsewhere_px = 0;  // half of the circles lie so far beside the ball
  // Angles on keyframes err by this too, alike over so many frames.
  double dust_deg = 0, dust_frames = 10;
};

constexpr double kCircle_px = 0.004, kStep_px = 0.002, kTurn_deg = 0.002;

std::vector<TrackRow> rows_of(const Flight& f, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  const auto deviate = [&] { return normal(random); };
  const double rim_x = f.rim_px * deviate(), rim_y = f.rim_px * deviate();
  const double off_x = f.offset_px * deviate(), off_y = f.offset_px * deviate();
  std::vector<TrackRow> rows;
  const double goes_on = std::exp(-1 / f.dust_frames);
  double dust_deg = f.dust_deg > 0 ? f.dust_deg * deviate() : 0;
  for (int i = 0; i < f.frames; ++i) {
    TrackRow row;
    const double turned = f.spin_deg * i * kRadPerDeg, c = std::cos(turned), s = std::sin(turned);
    row.frame = i;
    row.status = TrackStatus::kOk;
    row.circle_ok = true;
    const double x = 200 + f.vx * i, y = 250 - f.vy * i;  // y down
    row.cx_px = x + c * rim_x + s * rim_y + kCircle_px * deviate();
    row.cy_px = y - s * rim_x + c * rim_y + kCircle_px * deviate();
    row.cx_sd_px = row.cy_sd_px = f.rim_px;
    if (f.elsewhere_px > 0 && 4 * i > f.frames && 4 * i < 3 * f.frames) {
      row.cx_px += f.elsewhere_px;
      row.status = TrackStatus::kInconsistent;
    }
    row.r_px = 80;
    row.r_sd_px = 0.02;
    row.motion_ok = i + 1 < f.frames;
    row.dx_px = (1 - f.alike) * f.vx + kStep_px * deviate();
    row.dy_px = -(1 - f.alike) * f.vy + kStep_px * deviate();
    row.rot_deg = (1 - f.alike) * f.spin_deg + kTurn_deg * deviate();
    row.dx_sd_px = row.dy_sd_px = kStep_px;
    row.rot_sd_deg = kTurn_deg;
    if (f.poses) {
      BodyPose& pose = row.pose;
      pose.ok = true;
      pose.origin = pose.keyframe = 0;
      pose.x_px = x + c * off_x + s * off_y + 0.7 * kStep_px * deviate();
      pose.y_px = y - s * off_x + c * off_y + 0.7 * kStep_px * deviate();
      pose.angle_rad = turned + (0.7 * kTurn_deg * deviate() + dust_deg) * kRadPerDeg;
      if (f.dust_deg > 0) {
        const double own = std::sqrt(1 - goes_on * goes_on) * f.dust_deg;
        dust_deg = goes_on * dust_deg + own * deviate();
      }
      pose.x_sd_px = pose.y_sd_px = kStep_px;
      pose.angle_sd_rad = kTurn_deg * kRadPerDeg;
    }
    rows.push_back(row);
  }
  if (f.origin_sd_px > 0) rows[0].cx_sd_px = rows[0].cy_sd_px = f.origin_sd_px;
  return rows;
}

// Errors over deviations of both velocities and of the spin, rms over so many flights.
struct OverSds {
  double velocity = 0, spin = 0;
};

OverSds over_sds(const Flight& f, int flights = 40) {
  double velocity = 0, spin = 0;
  for (int seed = 1; seed <= flights; ++seed) {
    const ImpactAnalysis found =
        impact::analyse_impact(rows_of(f, static_cast<unsigned>(seed)), {});
    EXPECT_EQ(found.status, ImpactStatus::kNone);
    const FlightMotion& flight = found.flight;
    velocity += std::pow((flight.vt.value - f.vx) / flight.vt.sd, 2) +
                std::pow((flight.vn.value - f.vy) / flight.vn.sd, 2);
    spin +=
        std::pow((flight.spin.value * kDegPerRad - f.spin_deg) / (flight.spin.sd * kDegPerRad), 2);
  }
  return {std::sqrt(velocity / (2 * flights)), std::sqrt(spin / flights)};
}

TEST(FlatFlight, VelocityAndSpinAreAsSureAsTheyAre) {
  for (const double spin_deg : {0.05, 0.4, 3.0}) {
    for (const int frames : {12, 40, 200}) {
      Flight flight;
      flight.spin_deg = spin_deg;
      flight.frames = frames;
      const OverSds errors = over_sds(flight);
      std::printf("%.2f deg, %d frames: %.2f %.2f\n", spin_deg, frames, errors.velocity,
                  errors.spin);
      EXPECT_LT(errors.velocity, 1.3) << spin_deg << " deg, " << frames;
      EXPECT_GT(errors.velocity, 0.15) << spin_deg << " deg, " << frames;
      EXPECT_LT(errors.spin, 1.3) << spin_deg << " deg, " << frames;
      EXPECT_GT(errors.spin, 0.15) << spin_deg << " deg, " << frames;
    }
  }
}

// A pattern that stands still on the sensor, or a bar's edge: steps are too small by the same share
// in every frame.
TEST(FlatFlight, WhatStepsHaveAlikeDoesNotAddUp) {
  Flight flight;
  flight.alike = 0.003;
  const OverSds by_poses = over_sds(flight);
  EXPECT_LT(by_poses.velocity, 1.5);
  EXPECT_LT(by_poses.spin, 1.5);
  flight.poses = false;
  EXPECT_GT(over_sds(flight).spin, 4);
}

// A shadow's circles tell no places, and contradict no motion that keyframes bear out.
TEST(FlatFlight, CirclesElsewhereOnTheBodyDoNotCount) {
  Flight flight;
  flight.elsewhere_px = 3;
  EXPECT_LT(over_sds(flight).velocity, 1.3);
  EXPECT_LT(over_sds(flight).spin, 1.3);
}

// Dust that passes before the ball misleads the frames that it takes alike. Of what goes on for
// long a line takes a part along, which no scatter shows.
TEST(FlatFlight, AnglesThatErrAlikeKnowTheSpinLess) {
  Flight flight;
  flight.dust_deg = 0.006;
  for (const double frames : {3.0, 10.0}) {
    flight.dust_frames = frames;
    const double spin = over_sds(flight, 100).spin;
    std::printf("alike over %.0f frames: %.2f\n", frames, spin);
    EXPECT_LT(spin, frames > 5 ? 2 : 1.5);
    EXPECT_GT(spin, 0.7);
  }
}

// Poses that began in a contact, where a floor hid most of the rim, lead back to a place beside the
// centre, which turns about it.
TEST(FlatFlight, PosesThatBeganAtAPoorCircleAreNotTrusted) {
  Flight flight;
  flight.spin_deg = 0.1;
  flight.frames = 30;
  flight.offset_px = 0.8;
  flight.origin_sd_px = 1;
  EXPECT_LT(over_sds(flight).velocity, 1.3);
  flight.origin_sd_px = 0;
  EXPECT_GT(over_sds(flight).velocity, 3);
}

// A ball that lies on a tee until it is struck from the left, and falls from then on.
std::vector<TrackRow> struck_rows(double gravity, unsigned seed) {
  constexpr int kRest = 60, kContact = 20, kFlight = 70;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  std::vector<TrackRow> rows;
  double x = 200, y = 250, vx = 0, vy = 0;
  for (int i = 0; i <= kRest + kContact + kFlight; ++i) {
    TrackRow row;
    row.frame = i;
    row.status = TrackStatus::kOk;
    row.circle_ok = true;
    row.cx_px = x + kCircle_px * normal(random);
    row.cy_px = y + kCircle_px * normal(random);
    row.cx_sd_px = row.cy_sd_px = kCircle_px;
    row.r_px = 40;
    row.r_sd_px = 0.02;
    if (i >= kRest && i < kRest + kContact) {
      const double push = std::pow(std::sin(kPi * (i - kRest + 0.5) / kContact), 2) * 2 / kContact;
      vx += 1.6 * push, vy -= 0.5 * push;
    }
    if (i >= kRest + kContact) vy += gravity;
    row.motion_ok = i < kRest + kContact + kFlight;
    row.dx_px = vx + kStep_px * normal(random);
    row.dy_px = vy + kStep_px * normal(random);
    row.rot_deg = kTurn_deg * normal(random);
    row.dx_sd_px = row.dy_sd_px = kStep_px;
    row.rot_sd_deg = kTurn_deg;
    x += vx, y += vy;
    rows.push_back(row);
  }
  return rows;
}

TEST(FlatFlight, ABallThatRestsUntilItIsStruckDoesNotFallMeanwhile) {
  constexpr double kGravity = 2e-3;  // px/frame^2
  int found = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    impact::ImpactOptions options;
    options.surface_angle_rad = -kPi / 2;
    options.gravity = kGravity;
    const ImpactAnalysis struck = impact::analyse_impact(struck_rows(kGravity, seed), options);
    const bool is_found =
        struck.status == ImpactStatus::kFound || struck.status == ImpactStatus::kNotResolved;
    if (!is_found) continue;  // it may come in as well as out by chance
    ++found;
    EXPECT_NEAR(struck.fall.value, kGravity, 4 * struck.fall.sd) << seed;
    EXPECT_LT(struck.fall.sd, kGravity / 4) << seed;
  }
  EXPECT_GE(found, 4);
}

}  // namespace
}  // namespace impactdic::testing
