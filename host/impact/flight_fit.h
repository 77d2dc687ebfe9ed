// The two free flights on both sides of an impact, or a whole track that is one, fitted together:
// of a sphere positions, motions, turns about three axes and its radius as one least-squares
// problem. Internal to the impact analysis; pixels, frames, radians, local axes.
#pragma once

#include <impactdic/measured.h>

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>

#include "host/impact/impact_series.h"

namespace impactdic::impact {

// Instants of one flight, both included, and the instant at which its state is given.
struct FlightRange {
  std::size_t first = 0, last = 0;
  double at = 0;
};

// Indices of the state.
enum FlightState { kN0, kVn0, kT0, kVt0, kN1, kVn1, kT1, kVt1, kFlightStates };
// Of a sphere: spin about t and n, before and after.
enum SphereSpin { kSpinT0, kSpinN0, kSpinT1, kSpinN1, kSphereSpins };

struct FlightFit {
  bool ok = false;
  // NaN, zero where it is not ok.
  Eigen::Matrix<double, kFlightStates, 1> state = Eigen::Matrix<double, kFlightStates, 1>::Constant(
      kNotMeasured);  // px, px/frame; 0 before, 1 after
  Eigen::Matrix<double, kFlightStates, kFlightStates> covariance =
      Eigen::Matrix<double, kFlightStates, kFlightStates>::Zero();
  // Of `covariance` what no scatter shows: the errors that all frames of a flight share.
  Eigen::Matrix<double, kFlightStates, kFlightStates> common =
      Eigen::Matrix<double, kFlightStates, kFlightStates>::Zero();
  // Of the state, for a change of the gravity that was given, frames^2.
  Eigen::Matrix<double, kFlightStates, 1> per_gravity =
      Eigen::Matrix<double, kFlightStates, 1>::Zero();
  // rad/frame; NaN of a flat ball.
  Eigen::Matrix<double, kSphereSpins, 1> spin =
      Eigen::Matrix<double, kSphereSpins, 1>::Constant(kNotMeasured);
  Eigen::Matrix<double, kSphereSpins, kSphereSpins> spin_covariance =
      Eigen::Matrix<double, kSphereSpins, kSphereSpins>::Zero();
  // The same of the turn in the picture's plane, of both flights; NaN without keyframes.
  std::array<Measured, 2> roll;
  Measured radius_error;               // px by which a sphere's radius was taken too large
  double gravity = 0, gravity_sd = 0;  // px/frame^2; sd 0 where it was given
  double position_scale = 1;           // scatter over the deviations that the track states
  double step_scale = 1;
  // px/frame: what the velocities of centres and of steps differ by, beyond chance. It is part
  // of the velocities' deviations.
  double disagreement = 0;
  int used = 0, rejected = 0;
};

struct GravityDirection {
  double t = 0, n = 0;  // unit vector, local axes
};

// Weighted least squares on centres and measured steps; every centre and step that is further off
// than five times the scatter is left out. The deviations that the track states are scaled by the
// scatter found here; what the steps' say beyond their scatter is common to all of a flight's.
// An error of a sphere's radius bends its steps and turns in a known proportion
// (sphere::source_response): where the centres contradict the steps, that shows it. `gravity`
// nullopt: fitted, one for both flights.
FlightFit fit_flights(const ImpactSeries& series, const FlightRange& before,
                      const FlightRange& after, const GravityDirection& direction,
                      std::optional<double> gravity);

// The acceleration that both flights show across `direction`, counter-clockwise of it, where
// `gravity` acts along it; px/frame^2. NaN where there is too little to tell.
Measured fall_across(const ImpactSeries& series, const FlightRange& before,
                     const FlightRange& after, const GravityDirection& direction, double gravity);
// The same of one flight; what is after is NaN.
FlightFit fit_flight(const ImpactSeries& series, const FlightRange& range,
                     const GravityDirection& direction, std::optional<double> gravity);

}  // namespace impactdic::impact
