// What the frames of a flight say of it, as rows of a linear least-squares problem. Internal to the
// impact analysis; pixels, frames, radians, local axes.
#pragma once

#include <array>
#include <vector>

#include "host/impact/flight_fit.h"

namespace impactdic::impact {

inline constexpr int kStatesOfOne = kFlightStates / 2;

enum class DatumKind { kCentre, kStep, kTurn };  // turns: of a sphere, out of the picture's plane

// One row: value = slope · state + gravity_slope · gravity + … + error.
struct Datum {
  std::array<int, 2> column;    // of the state: position and velocity; of a turn both velocities
  std::array<double, 2> slope;  // what they contribute
  double gravity_slope, across_slope;
  double value, sd;
  DatumKind kind;
  int spin = -1;  // SphereSpin, of a turn
  // Of a sphere, and how the place on it that is taken for its centre turns along.
  double radius_slope = 0;
  std::array<double, 2> offset_slope{};
  int flight = 0;
  bool used = true;
};

// Centres, steps and, of a sphere, turns of flight number `flight` (0: before); what was not
// measured is left out.
std::vector<Datum> flight_data(const ImpactSeries& series, const GravityDirection& direction,
                               const FlightRange& range, int flight);

}  // namespace impactdic::impact
