#include "host/impact/flight_data.h"

#include <cmath>

namespace impactdic::impact {
namespace {

// Where a place on the ball, one px along t or n from its centre at the beginning, is seen along
// n (`normal`) or t after a turn in the picture's plane, less where it was.
std::array<double, 2> turned_offset(double turned, bool normal) {
  const double c = std::cos(turned), s = std::sin(turned);
  return normal ? std::array{s, c - 1} : std::array{c - 1, -s};
}

std::array<double, 2> moved_offset(double from, double to, bool normal) {
  const auto a = turned_offset(from, normal), b = turned_offset(to, normal);
  return {b[0] - a[0], b[1] - a[1]};
}

class FlightData {
 public:
  FlightData(const ImpactSeries& series, const GravityDirection& direction, int flight)
      : series_(series), direction_(direction), flight_(flight) {}

  // Instant `i`, so many frames after the flight's own; the last one's motion leads out of it.
  void add(std::size_t i, double from, bool last) {
    const bool moves = !last && !series_.from_circle;
    const SphereStep sphere = series_.sphere && moves ? (*series_.sphere)[i] : SphereStep{};
    for (const bool normal : {true, false}) {
      add_centre(i, from, normal);
      if (moves) add_step(sphere, i, from, normal);
    }
    if (sphere.ok) add_turns(sphere, i, from);
    if (!last && std::isfinite(series_.turn[i])) turned_ += series_.turn[i];
  }

  std::vector<Datum> data;

 private:
  int column(bool normal) const { return flight_ * kStatesOfOne + (normal ? kN0 : kT0); }
  double pull(bool normal) const { return normal ? direction_.n : direction_.t; }
  double across(bool normal) const { return normal ? direction_.t : -direction_.n; }

  void keep(Datum datum) {
    datum.flight = flight_;
    if (std::isfinite(datum.value)) data.push_back(datum);
  }

  void add_centre(std::size_t i, double from, bool normal) {
    Datum seen = {{column(normal), column(normal) + 1},
                  {1, from},
                  pull(normal) * from * from / 2,
                  across(normal) * from * from / 2,
                  normal ? series_.position_n[i] : series_.position_t[i],
                  series_.position_sd[i],
                  DatumKind::kCentre};
    if (series_.sphere) seen.offset_slope = turned_offset(turned_, normal);
    keep(seen);
  }

  void add_step(const SphereStep& sphere, std::size_t i, double from, bool normal) {
    Datum moved = {{column(normal), column(normal) + 1},
                   {0, 1},
                   pull(normal) * (from + 0.5),
                   across(normal) * (from + 0.5),
                   normal ? series_.step_n[i] : series_.step_t[i],
                   series_.step_sd[i],
                   DatumKind::kStep};
    if (sphere.ok) {
      moved.sd = sphere.step_sd[normal ? 1 : 0];
      moved.radius_slope = sphere.step_to_radius[normal ? 1 : 0];
      moved.offset_slope = moved_offset(turned_, turned_ + series_.turn[i], normal);
    }
    keep(moved);
  }

  // A step and the turn across it err together: the turn is taken less what the step's error makes
  // of it, which is then independent of the step.
  void add_turns(const SphereStep& sphere, std::size_t i, double from) {
    const auto along = moved_offset(turned_, turned_ + series_.turn[i], false);
    const auto up = moved_offset(turned_, turned_ + series_.turn[i], true);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto& [by_t, by_n] = sphere.by_step[axis];
      Datum turn = {{column(true) + 1, column(false) + 1},
                    {-by_n, -by_t},
                    -(by_t * pull(false) + by_n * pull(true)) * (from + 0.5),
                    -(by_t * across(false) + by_n * across(true)) * (from + 0.5),
                    sphere.turn[axis] - by_t * series_.step_t[i] - by_n * series_.step_n[i],
                    sphere.turn_sd[axis],
                    DatumKind::kTurn};
      turn.spin = 2 * flight_ + static_cast<int>(axis);
      turn.radius_slope = sphere.turn_to_radius[axis] - by_t * sphere.step_to_radius[0] -
                          by_n * sphere.step_to_radius[1];
      for (std::size_t k = 0; k < 2; ++k) turn.offset_slope[k] = -by_t * along[k] - by_n * up[k];
      keep(turn);
    }
  }

  const ImpactSeries& series_;
  GravityDirection direction_;
  int flight_;
  double turned_ = 0;  // rad in the picture's plane since the first row
};

}  // namespace

std::vector<Datum> flight_data(const ImpactSeries& series, const GravityDirection& direction,
                               const FlightRange& range, int flight) {
  FlightData rows(series, direction, flight);
  for (std::size_t i = range.first; i <= range.last; ++i) {
    rows.add(i, static_cast<double>(i) - range.at, i == range.last);
  }
  return rows.data;
}

}  // namespace impactdic::impact
