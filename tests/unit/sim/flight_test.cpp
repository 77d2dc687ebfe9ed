// Flights in the air: closed forms, the ledger, and a fit that finds the coefficients.
#include "sim/contact/flight/flight.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <impactdic/units.h>

#include <cmath>

#include "sim/contact/impact.h"
#include "sim/fit/calibration.h"
#include "sim/job/job_toml.h"
#include "sim/job/source_jobs.h"
#include "tests/support/fitted_shots.h"
#include "tests/support/job_text.h"

namespace impactdic {
namespace {

using sim::contact::Flight;
using sim::contact::ImpactState;
using sim::contact::JobNumbers;

ImpactJob ball_in_air(double drag, double lift) {
  ImpactJob job = testing::tennis_shot(0, 0, -10);
  job.air.drag_coefficient = drag;
  job.air.lift_coefficient = lift;
  return job;
}

// rho A / (2 m), 1/m.
double pressed(const ImpactJob& job) {
  const double r = job.body.radius_m();
  return job.air.density_kg_m3 * kPi * r * r / (2 * job.body.mass_kg);
}

TEST(Flight, DragAloneIsTheClosedForm) {
  ImpactJob job = ball_in_air(0.55, 0);
  job.gravity_m_s2 = 0;
  const double k = 0.55 * pressed(job), speed = 30;
  ImpactState start{};
  start[sim::contact::kVt] = 0.6 * speed, start[sim::contact::kVn] = 0.8 * speed;
  for (const double t : {0.3, -0.2}) {
    const Flight<double>::Flown flown = Flight<double>(JobNumbers<double>(job)).after(start, t);
    const double way = std::log1p(k * speed * t) / k, after = speed / (1 + k * speed * t);
    EXPECT_NEAR(flown.state[sim::contact::kQt], 0.6 * way, 1e-11);
    EXPECT_NEAR(flown.state[sim::contact::kVn], 0.8 * after, 1e-11);
    const double lost = 0.5 * job.body.mass_kg * (speed * speed - after * after);
    EXPECT_NEAR(flown.air_j, lost, 1e-10 * std::abs(lost));
  }
}

// Without weight and drag Magnus' force leads a ball round on a circle of radius v/W, W = lift
// omega.
TEST(Flight, TouchesWhereACircleMeetsTheSurface) {
  ImpactJob job = ball_in_air(0, 1);
  job.body.mass_kg = 1e-4;  // light, so that it turns within a few steps
  job.gravity_m_s2 = 0;
  const double turning = pressed(job) * job.body.radius_m() * 500;
  const Flight<double> flight{JobNumbers<double>(job)};
  ImpactState start{};
  start[sim::contact::kOmega] = -500;  // bends down where it flies along t
  start[sim::contact::kVt] = 3;
  const double radius = 3 / turning;
  for (const double part : {0.3, 1.2, 1.99, 1.9999999}) {  // of the radius, down to the touch
    start[sim::contact::kQn] = part * radius;
    EXPECT_NEAR(flight.time_to_touch(start) * turning, std::acos(1 - part), 1e-8) << part;
  }
  // Just left, and back within a part of a step.
  start[sim::contact::kQn] = 0;
  for (const double rise : {1e-5, 1e-3, 0.5}) {
    start[sim::contact::kVt] = std::cos(rise), start[sim::contact::kVn] = std::sin(rise);
    EXPECT_NEAR(flight.time_to_touch(start) * turning, 2 * rise, 1e-8 * rise) << rise;
  }
}

TEST(Flight, AFallReachesItsTerminalSpeedAsTheClosedForm) {
  const ImpactJob job = ball_in_air(0.5, 0);
  const double terminal = std::sqrt(9.81 / (0.5 * pressed(job)));
  const Flight<double>::Flown flown =
      Flight<double>(JobNumbers<double>(job)).after(ImpactState{}, 2);
  EXPECT_NEAR(flown.state[sim::contact::kVn], -terminal * std::tanh(9.81 * 2 / terminal), 1e-10);
  EXPECT_NEAR(flown.state[sim::contact::kQn],
              -terminal * terminal / 9.81 * std::log(std::cosh(9.81 * 2 / terminal)), 1e-10);
}

TEST(Flight, MagnusAloneFliesACircleAndBackspinLifts) {
  ImpactJob job = ball_in_air(0, 1);
  job.gravity_m_s2 = 0;
  ImpactState start{};
  start[sim::contact::kVt] = 20;
  start[sim::contact::kOmega] = 300;  // counter-clockwise, flying to the right: backspin
  const double rate = pressed(job) * job.body.radius_m() * 300;
  const Flight<double>::Flown flown = Flight<double>(JobNumbers<double>(job)).after(start, 0.5);
  EXPECT_NEAR(flown.state[sim::contact::kVt], 20 * std::cos(rate * 0.5), 1e-10);
  EXPECT_NEAR(flown.state[sim::contact::kVn], 20 * std::sin(rate * 0.5), 1e-10);
  EXPECT_NEAR(flown.state[sim::contact::kQn], 20 / rate * (1 - std::cos(rate * 0.5)), 1e-10);
  EXPECT_GT(flown.state[sim::contact::kVn], 0);
  EXPECT_EQ(flown.air_j, 0);
}

TEST(Flight, TheTouchIsWhereTheFlightComesDown) {
  const ImpactJob job = ball_in_air(0.5, 0.8);
  const Flight<double> flight(JobNumbers<double>{job});
  ImpactState start{};
  start[sim::contact::kVt] = 15, start[sim::contact::kVn] = 6, start[sim::contact::kOmega] = -100;
  const double touch = flight.time_to_touch(start);
  EXPECT_NEAR(flight.after(start, touch).state[sim::contact::kQn], 0, 1e-12);
  EXPECT_GT(touch, 0.3);
  EXPECT_LT(touch, 2 * 6 / 9.81);  // topspin and drag bring it down sooner
  start[sim::contact::kQn] = 1e-9, start[sim::contact::kVn] = 1;
  ImpactJob lifted = job;
  lifted.gravity_m_s2 = 0, lifted.air.lift_coefficient = 0;
  EXPECT_TRUE(std::isinf(Flight<double>(JobNumbers<double>(lifted)).time_to_touch(start)));
}

TEST(Flight, TheLedgerClosesWithTheAirsShare) {
  ImpactJob job = ball_in_air(0.6, 1.1);
  job.initial.vt_m_s = 12, job.initial.omega_rad_s = 150, job.initial.gap_m = 0.5;
  job.solver.contacts = 3;
  const ImpactResult result = sim::contact::simulate_impact(job, {.rate_hz = 2000});
  EXPECT_GT(result.energy.air_j, 0.01 * result.energy.kinetic_start_j);
  EXPECT_LT(std::abs(result.energy.residual_j), 1e-9 * result.energy.kinetic_start_j);
  for (const TrajectoryPoint& point : result.trajectory) {
    EXPECT_LT(std::abs(point.energy.residual_j), 1e-8 * result.energy.kinetic_start_j);
  }
  EXPECT_GT(result.trajectory.back().time_s, 0.1);
}

TEST(Flight, AirStandsInTheJobAndIsOfOneBallAlone) {
  ImpactJob job = ball_in_air(0.5, 1.2);
  const std::string text = sim::job::to_toml(SimulateRequest{.impact = job});
  const ImpactJob read = sim::job::read_simulate_job(testing::write_job(text)).impact;
  EXPECT_EQ(read.air.drag_coefficient, 0.5);
  EXPECT_EQ(read.air.lift_coefficient, 1.2);
  EXPECT_EQ(sim::job::to_toml(SimulateRequest{.impact = read}), text);
  job.air.drag_coefficient = -1;
  EXPECT_THROW(job.validate(), InvalidArgument);
  job = ball_in_air(0.5, 0);
  job.other = OtherBody{job.body, {}};
  EXPECT_THROW(job.validate(), InvalidArgument);
}

// A fast shot with 90 frames of flight on each side.
FitRequest shot_in_air(const std::filesystem::path& file, bool fitted, bool air = true) {
  testing::SyntheticTrack track;
  track.job = ball_in_air(0.55, 1);
  track.job.initial.vt_m_s = -18, track.job.initial.vn_m_s = -16;
  track.job.initial.omega_rad_s = 150;
  if (!air) track.job.air = {};
  track.fps = 1500, track.frames_before = track.frames_after = 90, track.frames_contact = 11;
  track.position_noise_m = track.stated_sd_m = 13e-6;
  track.motion = true, track.motion_noise_m = 1.3e-6, track.turn_noise_rad = 3.5e-4;
  write_track(track, file);
  FitRequest request;
  request.shots = {{file, 0}};
  request.impact = track.job;
  request.impact.contact.stiffness = request.impact.contact.damping_n_s_per_m = 0;
  request.impact.air = {};
  request.parameters = {FitParameter::kStiffness, FitParameter::kDamping};
  if (fitted) {
    request.parameters.push_back(FitParameter::kDrag);
    request.parameters.push_back(FitParameter::kLift);
  }
  request.flight_frames = 200;
  request.threads = 1;
  return request;
}

TEST(FlightFit, FindsDragAndLift) {
  testing::ScratchFolder folder;
  const ShotFit fit = sim::fit::calibrate(shot_in_air(folder / "track.csv", true)).shots[0];
  const ParameterEstimate &drag = fit.parameters[2], &lift = fit.parameters[3];
  EXPECT_EQ(drag.key, "drag_coefficient");
  EXPECT_LT(std::abs(drag.value - 0.55), 3 * drag.sd);
  EXPECT_LT(drag.sd, 0.02);
  EXPECT_LT(std::abs(lift.value - 1), 3 * lift.sd);
  EXPECT_LT(lift.sd, 0.05);
  EXPECT_EQ(fit.adequacy, Adequacy::kAdequate);
}

TEST(FlightFit, AFlightThatBendsIsToldWhereNoAirIsGiven) {
  testing::ScratchFolder folder;
  const auto told = [&](bool air) {
    FitRequest request = shot_in_air(folder / "track.csv", false, air);
    request.rivals = true;
    request.parameters = {FitParameter::kDamping};  // few rivals: this is about the flights
    request.impact.contact.stiffness = testing::tennis_shot(0, 0, -1).contact.stiffness;
    const auto warnings = sim::fit::calibrate(request).shots[0].warnings;
    return std::any_of(warnings.begin(), warnings.end(), [](const std::string& w) {
      return w.find("drag_coefficient") != std::string::npos;
    });
  };
  EXPECT_TRUE(told(true));
  EXPECT_FALSE(told(false));
}

}  // namespace
}  // namespace impactdic
