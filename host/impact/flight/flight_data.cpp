#include "host/impact/flight/flight_data.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/base/statistics.h"

namespace impactdic::impact {
namespace {

// turned_place less where it was.
std::array<double, 2> turned_offset(double turned, bool normal) {
  std::array<double, 2> place = turned_place(turned, normal);
  place[normal ? 1 : 0] -= 1;
  return place;
}

std::array<double, 2> moved_offset(double from, double to, bool normal) {
  const auto a = turned_offset(from, normal), b = turned_offset(to, normal);
  return {b[0] - a[0], b[1] - a[1]};
}

// 0 where no row has one.
double usual_turn(const ImpactSeries& series, const FlightRange& range) {
  std::vector<double> turns;
  for (std::size_t i = range.first; i < range.last; ++i) turns.push_back(series.turn(i));
  turns = finite(turns);
  return turns.empty() ? 0 : upper_median(std::move(turns));
}

// Whether the ball lies still.
bool rests(const ImpactSeries& series, const FlightRange& range) {
  constexpr std::size_t kFewest = 9;  // frames
  constexpr double kStill_px = 0.1;
  if (range.last - range.first + 1 < kFewest) return false;
  const std::size_t third = (range.last - range.first + 1) / 3;
  std::array<double, 3> t{}, n{};
  for (std::size_t part = 0; part < 3; ++part) {
    std::vector<double> along, above;
    for (std::size_t i = range.first + part * third; i < range.first + (part + 1) * third; ++i) {
      along.push_back(series.position_t(i));
      above.push_back(series.position_n[i]);
    }
    along = finite(along), above = finite(above);
    if (along.empty()) return false;
    t[part] = upper_median(std::move(along)), n[part] = upper_median(std::move(above));
  }
  const auto spread = [](const std::array<double, 3>& places) {
    return *std::max_element(places.begin(), places.end()) -
           *std::min_element(places.begin(), places.end());
  };
  return spread(t) < kStill_px && spread(n) < kStill_px;
}

class FlightData {
 public:
  FlightData(const ImpactSeries& series, const GravityDirection& direction,
             const FlightRange& range, int flight)
      : series_(series),
        direction_(direction),
        flight_(flight),
        rim_off_(series.rim_off(range.first, range.last)),
        usual_turn_(usual_turn(series, range)) {}

  // Instant `i`, so many frames after the flight's own; the last one's motion leads out of it.
  void add(std::size_t i, double from, bool last) {
    const bool moves = !last && !series_.from_circle;
    const SphereStep sphere = series_.sphere && moves ? (*series_.sphere)[i] : SphereStep{};
    for (const bool normal : {true, false}) {
      add_centre(i, from, normal);
      if (moves) add_step(sphere, i, from, normal);
    }
    if (sphere.ok) add_turns(sphere, i, from);
    const double turn = last ? 0 : series_.turn(i);
    turned_ += std::isfinite(turn) ? turn : usual_turn_;
  }

  std::vector<Datum> data;

 private:
  static std::size_t column(bool normal) { return normal ? kN0 : kT0; }
  double pull(bool normal) const { return normal ? direction_.n : direction_.t; }
  double across(bool normal) const { return normal ? direction_.t : -direction_.n; }

  void keep(const Datum& datum) {
    if (std::isfinite(datum.value)) data.push_back(datum);
  }

  Datum begun(DatumKind kind, bool normal) const {
    Datum datum;
    datum.kind = kind;
    datum.normal = normal;
    datum.flight = flight_;
    return datum;
  }

  void add_centre(std::size_t i, double from, bool normal) {
    Datum seen = begun(DatumKind::kCentre, normal);
    seen.slope[column(normal)] = 1;
    seen.slope[column(normal) + 1] = from;
    seen.gravity_slope = pull(normal) * from * from / 2;
    seen.across_slope = across(normal) * from * from / 2;
    seen.value = normal ? series_.position_n[i] - rim_off_[1] : series_.position_t(i) - rim_off_[0];
    seen.sd = series_.position_sd(i);
    if (series_.sphere) {
      seen.offset_slope = turned_offset(turned_, normal);
    } else {
      seen.rim_slope = turned_place(turned_, normal);
    }
    keep(seen);
  }

  Datum step(const SphereStep& sphere, std::size_t i, double from, bool normal) const {
    Datum moved = begun(DatumKind::kStep, normal);
    moved.slope[column(normal) + 1] = 1;
    moved.gravity_slope = pull(normal) * (from + 0.5);
    moved.across_slope = across(normal) * (from + 0.5);
    moved.value = normal ? series_.step_n[i] : series_.step_t(i);
    moved.sd = series_.step_sd(i);
    if (sphere.ok) {
      moved.sd = sphere.step_sd[normal ? 1 : 0];
      moved.radius_slope = sphere.step_to_radius[normal ? 1 : 0];
      moved.nearness_slope = sphere.step_to_nearness[normal ? 1 : 0];
      moved.offset_slope = moved_offset(turned_, turned_ + series_.turn(i), normal);
    }
    return moved;
  }
  void add_step(const SphereStep& sphere, std::size_t i, double from, bool normal) {
    keep(step(sphere, i, from, normal));
  }

  // A step and the turn across it err together: the turn is taken less what the step's error makes
  // of it, which is then independent of the step.
  void add_turns(const SphereStep& sphere, std::size_t i, double from) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      Datum turn = begun(DatumKind::kTurn, axis == 1);
      turn.spin_slope[axis] = 1;
      turn.value = sphere.turn[axis];
      turn.sd = sphere.turn_sd[axis];
      turn.radius_slope = sphere.turn_to_radius[axis];
      turn.nearness_slope = sphere.turn_to_nearness[axis];
      for (const bool normal : {false, true}) {
        take_off(turn, sphere.by_step[axis][normal ? 1 : 0], step(sphere, i, from, normal));
      }
      keep(turn);
    }
  }

  const ImpactSeries& series_;
  GravityDirection direction_;
  int flight_;
  std::array<double, 2> rim_off_;
  double usual_turn_;  // rad a frame, for rows without one
  double turned_ = 0;  // rad in the picture's plane since the first row
};

}  // namespace

std::array<double, 2> turned_place(double turned, bool normal) {
  const double c = std::cos(turned), s = std::sin(turned);
  return normal ? std::array{s, c} : std::array{c, -s};
}

void take_off(Datum& row, double factor, const Datum& other) {
  for (std::size_t k = 0; k < row.slope.size(); ++k) row.slope[k] -= factor * other.slope[k];
  for (std::size_t k = 0; k < 2; ++k) row.offset_slope[k] -= factor * other.offset_slope[k];
  row.gravity_slope -= factor * other.gravity_slope;
  row.across_slope -= factor * other.across_slope;
  row.radius_slope -= factor * other.radius_slope;
  row.nearness_slope -= factor * other.nearness_slope;
  row.value -= factor * other.value;
}

double usual_deviation(const std::vector<Datum>& data, DatumKind kind) {
  std::vector<double> stated;
  for (const Datum& d : data) {
    if (d.used && d.kind == kind) stated.push_back(d.sd);
  }
  return stated.empty() ? 0.0 : upper_median(finite(stated));
}

void give_usual_deviations(std::vector<Datum>& data) {
  constexpr double kLeastSd_px = 1e-7, kUsualSd_px = 1e-2;
  for (const DatumKind kind : {DatumKind::kCentre, DatumKind::kStep}) {
    std::vector<double> stated;
    for (const Datum& d : data) {
      if (d.kind == kind && d.sd > kLeastSd_px) stated.push_back(d.sd);
    }
    const double usual = stated.empty() ? kUsualSd_px : upper_median(finite(stated));
    for (Datum& d : data) {
      if (d.kind == kind && !(d.sd > kLeastSd_px)) d.sd = usual;
    }
  }
}

bool is_borne(const ImpactSeries& series, const std::vector<FlightRange>& ranges, int flight) {
  if (ranges.size() != 2) return false;
  const auto at = static_cast<std::size_t>(flight);
  return rests(series, ranges[at]) && !rests(series, ranges[1 - at]);
}

void take_weight_off(std::vector<Datum>& rows) {
  for (Datum& row : rows) row.gravity_slope = row.across_slope = 0;
}

std::vector<Datum> flight_data(const ImpactSeries& series, const GravityDirection& direction,
                               const FlightRange& range, int flight) {
  FlightData rows(series, direction, range, flight);
  for (std::size_t i = range.first; i <= range.last; ++i) {
    rows.add(i, static_cast<double>(i) - range.at, i == range.last);
  }
  return rows.data;
}

}  // namespace impactdic::impact
