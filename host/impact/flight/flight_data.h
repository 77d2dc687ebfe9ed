// What the frames of a flight say of it, as rows of a linear least-squares problem. Internal to the
// impact analysis; pixels, frames, radians, local axes.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "host/impact/flight_fit.h"

namespace impactdic::impact {

inline constexpr int kStatesOfOne = kFlightStates / 2;

// Turns are a sphere's, out of the picture's plane. The last three are registrations against
// keyframes: place, turns out of the picture's plane and in it.
enum class DatumKind { kCentre, kStep, kTurn, kShift, kTilt, kRoll };
inline constexpr std::size_t kDatumKinds = 6;

// One row: value = slope · the flight's state + gravity_slope · gravity + … + error.
struct Datum {
  std::array<double, kStatesOfOne> slope{};  // as the states of FlightState of one flight
  double gravity_slope = 0, across_slope = 0;
  double value = 0, sd = 0;
  DatumKind kind = DatumKind::kCentre;
  bool normal = false;                 // along n, else t
  std::array<double, 3> spin_slope{};  // about t, n and b
  // Of a sphere, and how the place on it that is taken for its centre turns along.
  double radius_slope = 0, nearness_slope = 0;
  std::array<double, 2> offset_slope{};
  // Of a flat ball's circle, how what its texture misplaces it by turns along.
  std::array<double, 2> rim_slope{};
  // Of a registration against a keyframe: how far the ball has turned out of the picture's plane
  // since, about the row's axis, and for a turn in the plane in all.
  double tilted_slope = 0, rolled_slope = 0;
  int flight = 0;
  // Rows of one group err alike, too: by `loose` times their deviation, and in proportion to
  // `reach` times it.
  int group = -1;
  double loose = 0, reach = 0;
  bool fitted = true;  // false: its scatter alone is of interest
  bool used = true;
};

// Of a flight's frames that must lean on keyframes if these are to take the place of steps.
inline constexpr double kFewestLinked = 0.8;
// How far a flat ball's places and angles on a keyframe may drift over a flight, deviations of one.
inline constexpr double kLinkDrift = 0.5;

// Where a place on the ball, one px along t or n from its centre at the beginning, is along n
// (`normal`) or t after a turn in the picture's plane, rad.
std::array<double, 2> turned_place(double turned, bool normal);

// Takes `factor` times the row `other` off `row`.
void take_off(Datum& row, double factor, const Datum& other);

// Whether the ball rests in one of two flights, as on a tee until it is struck: it does not fall
// meanwhile, for something bears its weight. Of a single flight nothing tells.
bool is_borne(const ImpactSeries& series, const std::vector<FlightRange>& ranges, int flight);
// Rows of a ball that does not fall.
void take_weight_off(std::vector<Datum>& rows);

// Centres, steps and, of a sphere, turns of flight number `flight` (0: before); what was not
// measured is left out.
std::vector<Datum> flight_data(const ImpactSeries& series, const GravityDirection& direction,
                               const FlightRange& range, int flight);

// The median of what data of one kind state, of those that are used; 0 where there are none.
double usual_deviation(const std::vector<Datum>& data, DatumKind kind);

// Centres and steps without a stated deviation get the others' median.
void give_usual_deviations(std::vector<Datum>& data);

}  // namespace impactdic::impact
