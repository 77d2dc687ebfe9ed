// The instant at which a surface begins, or ends, to act on a ball, from the motion alone. Internal
// to the impact analysis; pixels, frames, axis n out of the surface.
#pragma once

#include <impactdic/impact.h>

#include <Eigen/Core>

#include "host/impact/impact_series.h"

namespace impactdic::impact {

// Free flight: height and velocity along n at the instant `at`, and their covariance.
struct FreeFlightState {
  double at = 0;
  Eigen::Vector2d state;
  Eigen::Matrix2d covariance;
};

struct EdgeRequest {
  bool end = false;  // the end of the contact: the same, seen backwards in time
  FreeFlightState flight;
  double gravity_n = 0;
  double turn = 0;   // instant of the maximum compression
  double guess = 0;  // of the edge
  double peak_acceleration = 0;
  std::size_t from = 0;  // the instant, in free flight, from which on the track is fitted
  double position_scale = 1, step_scale = 1;  // scatter over stated deviations
  bool likeliest_alone = false;  // no other touch has a say: quick, with too small a deviation
};

struct ContactEdge {
  bool ok = false;
  double instant = 0, sd = 0;
  double exponent = 0, exponent_sd = 0;  // p of the onset
  double height = 0;                     // of the flight at the instant
  double misfit = 0;                     // reduced chi square
  double reach = 0;        // part of the way to the maximum compression that was fitted
  bool law_holds = false;  // the misfit is what chance makes of it

  ContactEdgeResult result() const { return {{instant, sd}, {exponent, exponent_sd}, law_holds}; }
};

// Beginning: the deflection x follows x'' = -a with a = K x^p + A v/v0 (v = x', v0 at the touch),
// a power law with a damper that strikes at once. End, seen backwards: a = K x^p + B (1 - v/v0),
// whose force fades to nothing whatever the damper does. All of touch, speed, K, p, A or B are
// fitted, p and A near what laws of contact have in common. The fit reaches to 95 % of the way to
// the maximum compression; if the law does not hold that far, less and less, so that the edge is
// not bent to suit the rest.
ContactEdge fit_edge(const ImpactSeries& series, const EdgeRequest& request);

// The instant at which the normal velocity is zero, by a line with a parabola on each side (the
// damper changes with the sign of the velocity) through `reach` frames on each side.
struct TurnInstant {
  bool ok = false;
  double instant = 0, sd = 0;
  double height = kNotMeasured, height_sd = kNotMeasured;  // there; from centres alone
};
TurnInstant fit_turn(const ImpactSeries& series, double guess, double reach,
                     double peak_acceleration, double position_scale, double step_scale);

}  // namespace impactdic::impact
