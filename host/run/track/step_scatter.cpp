#include "host/run/track/step_scatter.h"

#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "host/base/statistics.h"

namespace impactdic::run {
namespace {

// Steps that a line is laid through: more may be bent, fewer tell nothing of their scatter.
constexpr std::size_t kFewest = 6, kMost = 16;
// Of all together, below which nothing is said.
constexpr std::size_t kFewestOfAll = 16;
// Scatter that is chance (3.5 deviations of an rms), and that is too little to be told of.
constexpr double kChance = 2.5, kLeast = 1.25;
// Of the median's scatter: what lies farther off is another fault than scatter.
constexpr double kFarOff = 4;

// One component of motions, and what it states.
struct Component {
  double TrackRow::*value;
  double TrackRow::*sd;
};

// The weighted line through the values, over frames.
struct Line {
  double frame, value, value_sd, slope;  // at the middle of what it goes through
  double at(const TrackRow& row) const {
    return value + slope * (static_cast<double>(row.frame) - frame);
  }
};

Line line_through(const std::vector<TrackRow>& rows, const Component& of) {
  double w = 0, x = 0, y = 0, xx = 0, xy = 0;
  const double from = static_cast<double>(rows.front().frame);
  for (const TrackRow& row : rows) {
    const double value = row.*of.value, at = static_cast<double>(row.frame) - from;
    const double weight = 1 / (row.*of.sd * (row.*of.sd));
    w += weight, x += weight * at, y += weight * value;
    xx += weight * at * at, xy += weight * at * value;
  }
  const double slope = (w * xy - x * y) / (w * xx - x * x);
  return {from + x / w, y / w, 1 / std::sqrt(w), slope};
}

// Distances of values from where they should lie, over what they state.
class Scatter {
 public:
  // About the line through them, all of which may lie off by `bias`.
  void add_line(const std::vector<TrackRow>& rows, const Component& of, double bias) {
    const Line line = line_through(rows, of);
    if (!std::isfinite(line.slope)) return;
    const double count = static_cast<double>(rows.size());
    for (const TrackRow& row : rows) {
      const double off = (row.*of.value - line.at(row)) * std::sqrt(count / (count - 2));
      sizes_.push_back(std::abs(off + bias) / row.*of.sd);
    }
  }
  // About a constant.
  void add_level(const std::vector<TrackRow>& rows, const Component& of, double level) {
    for (const TrackRow& row : rows) {
      const double size = std::abs(row.*of.value - level) / row.*of.sd;
      if (std::isfinite(size)) sizes_.push_back(size);
    }
  }
  // The rms, but for what lies far off.
  double times_stated() const {
    if (sizes_.size() < kFewestOfAll) return 1;
    const double most = kFarOff * kSdOfMad * median(sizes_);
    double squares = 0, count = 0;
    for (const double size : sizes_) {
      if (size < most) squares += size * size, ++count;
    }
    const double times = std::sqrt(squares / count);
    return times > std::max(1 + kChance / std::sqrt(count), kLeast) ? times : 1;
  }

 private:
  std::vector<double> sizes_;
};

constexpr Component kX{&TrackRow::dx_px, &TrackRow::dx_sd_px};
constexpr Component kY{&TrackRow::dy_px, &TrackRow::dy_sd_px};
constexpr Component kTurn{&TrackRow::rot_deg, &TrackRow::rot_sd_deg};
constexpr Component kTiltX{&TrackRow::rot_x_deg, &TrackRow::rot_x_sd_deg};
constexpr Component kTiltY{&TrackRow::rot_y_deg, &TrackRow::rot_y_sd_deg};

class Flights {
 public:
  Flights(const TrackRows& rows, double surface_angle_rad)
      : rows_(rows), c_(std::cos(surface_angle_rad)), s_(std::sin(surface_angle_rad)) {}

  // Where there is no impact the flight's velocity is that in the middle of its rows, and what all
  // steps are off from it alike counts, too.
  void add_whole(const FlightMotion& flight) {
    const std::vector<TrackRow> rows = whole_rows(flight);
    if (rows.size() < kFewestOfAll) return;
    // A motion leads from its frame to the next one: it is that half a step later.
    const auto first = static_cast<double>(rows_[flight.first].frame);
    const auto last = static_cast<double>(rows_[flight.last].frame);
    const double step = (last - first) / static_cast<double>(flight.last - flight.first);
    const double middle = 0.5 * (first + last - step);
    bias_ = {bias_of(rows, kX, middle, flight.vx.value, flight.vx.sd),
             bias_of(rows, kY, middle, -flight.vy.value, flight.vy.sd)};
    add(flight);
  }
  void add(const FlightMotion& flight) {
    std::vector<TrackRow> run;
    for (std::size_t i = flight.first; i < flight.last; ++i) {
      const TrackRow row = rows_[i];
      const bool whole = is_whole(row);
      if (whole) run.push_back(row);
      if (!whole || run.size() == kMost || i + 1 == flight.last) take(run, flight);
    }
  }
  StepScatter found() const {
    return {move_.times_stated(), turn_.times_stated(), tilt_.times_stated()};
  }

 private:
  static bool is_whole(const TrackRow& row) {
    return row.status == TrackStatus::kOk && row.motion_ok && row.periods == 1;
  }
  std::vector<TrackRow> whole_rows(const FlightMotion& flight) const {
    std::vector<TrackRow> rows;
    for (std::size_t i = flight.first; i < flight.last; ++i) {
      if (const TrackRow row = rows_[i]; is_whole(row)) rows.push_back(row);
    }
    return rows;
  }
  // 0 where it may be chance.
  static double bias_of(const std::vector<TrackRow>& rows, const Component& of, double middle,
                        double velocity, double velocity_sd) {
    constexpr double kSure = 3;
    const Line line = line_through(rows, of);
    const double bias = line.value + line.slope * (middle - line.frame) - velocity;
    return std::abs(bias) > kSure * std::hypot(line.value_sd, velocity_sd) ? bias : 0;
  }

  // The spin is that of the whole flight, which its places on keyframes tell: what holds all steps
  // back alike shows, too.
  void take(std::vector<TrackRow>& run, const FlightMotion& flight) {
    if (run.size() >= kFewest) {
      move_.add_line(run, kX, bias_[0]);
      move_.add_line(run, kY, bias_[1]);
      turn_.add_level(run, kTurn, flight.spin.value * kDegPerRad);
      const double t = flight.spin_t.value * kDegPerRad, n = flight.spin_n.value * kDegPerRad;
      tilt_.add_level(run, kTiltX, c_ * t - s_ * n);
      tilt_.add_level(run, kTiltY, s_ * t + c_ * n);
    }
    run.clear();
  }

  TrackRows rows_;
  double c_, s_;
  std::array<double, 2> bias_{};  // of steps, px
  Scatter move_, turn_, tilt_;
};

}  // namespace

void StepScatter::widen(TrackRow& row) const {
  row.dx_sd_px *= move;
  row.dy_sd_px *= move;
  row.rot_sd_deg *= turn;
  row.rot_x_sd_deg *= tilt;
  row.rot_y_sd_deg *= tilt;
}

std::string StepScatter::warning() const {
  if (!is_more()) return "";
  char text[240];
  std::snprintf(text, sizeof text,
                "motions scatter by more than the pictures' noise tells (displacements %.1f, turns "
                "%.1f times): their deviations are those of the scatter. A colour camera, a filter "
                "of the recorder, or a thing before the ball does so",
                move, std::max(turn, tilt));
  return text;
}

StepScatter scatter_of_steps(const TrackRows& rows, const ImpactAnalysis& impact,
                             double surface_angle_rad) {
  Flights flights(rows, surface_angle_rad);
  flights.add(impact.before);
  flights.add(impact.after);
  flights.add_whole(impact.flight);
  return flights.found();
}

}  // namespace impactdic::run
