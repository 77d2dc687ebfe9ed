#include "host/impact/impact_phases.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "host/base/statistics.h"
#include "host/impact/contact_edge.h"
#include "host/impact/contact_guess.h"
#include "host/impact/flight_fit.h"
#include "host/impact/impact_figures.h"
#include "host/impact/impact_series.h"

namespace impactdic::impact {
namespace {

constexpr std::size_t kFewestFlightFrames = 6;
constexpr std::size_t kFewestContactFrames = 8;
constexpr double kSignificant = 8;  // deviations that an impact must stand out by

class Analysis {
 public:
  Analysis(const std::vector<TrackRow>& rows, const ImpactOptions& options)
      : options_(options), series_(impact_series(rows, options.surface_angle_rad)) {
    const double angle = options.gravity_angle_rad - options.surface_angle_rad;
    direction_ = {std::cos(angle), std::sin(angle)};
    result_.radius_px = median_radius_px(rows).value_or(kNotMeasured);
  }

  ImpactAnalysis run() {
    guess_ = guess_contact(series_, options_.gravity.value_or(0.0) * direction_.n);
    if (!guess_.found) return result_;
    if (!set_flights()) {
      result_.status = ImpactStatus::kFlightTooShort;
      return result_;
    }
    fit_both();
    if (!is_impact()) return result_;
    result_.status = ImpactStatus::kFound;
    find_contact();
    finish();
    return result_;
  }

 private:
  bool set_flights();
  void limit_flights();
  void trim(FlightRange& range, bool before) const;
  void fit_both() {
    flights_ = fit_flights(series_, before_, after_, direction_, options_.gravity);
  }
  bool is_impact() const;
  void find_contact();
  void refit(double length);
  void find_edges(double start_guess, double end_guess);
  ContactEdge edge(bool end, double near) const;
  Measured spin(const FlightRange& range) const;
  using Instant = std::function<double(const ImpactSources::Vector&)>;
  Measured above_lowest(const ImpactSources& sources, const Instant& instant) const;
  void place(const ImpactSources& sources, bool timed);
  void finish();

  ImpactOptions options_;
  ImpactSeries series_;
  GravityDirection direction_;
  ContactGuess guess_;
  FlightRange before_, after_;
  FlightFit flights_;
  TurnInstant turn_;
  ContactEdge start_, end_;
  ImpactAnalysis result_;
};

bool Analysis::set_flights() {
  const std::size_t length = guess_.last - guess_.first;
  std::size_t guard = std::max<std::size_t>(3, length * 3 / 20);
  const std::size_t last_row = series_.size() - 1;
  // In a short clip rather a shorter guard than no flight.
  while (guard > 2 && (guess_.first < guard + 2 * kFewestFlightFrames ||
                       guess_.last + guard + 2 * kFewestFlightFrames > last_row)) {
    --guard;
  }
  if (guess_.first < guard + kFewestFlightFrames ||
      guess_.last + guard + kFewestFlightFrames > last_row) {
    return false;
  }
  before_.last = guess_.first - guard;
  before_.at = static_cast<double>(guess_.first);
  after_.first = guess_.last + guard;
  after_.last = last_row;
  after_.at = static_cast<double>(guess_.last);
  limit_flights();
  trim(before_, true);
  trim(after_, false);
  return true;
}

void Analysis::limit_flights() {
  const auto longest = static_cast<std::size_t>(
      std::max(options_.flight_frames, static_cast<int>(kFewestFlightFrames)));
  before_.first = std::max(before_.first, before_.last - std::min(before_.last, longest));
  after_.last = std::min(after_.last, after_.first + longest);
}

// Cuts off what, further out, is no part of the same flight: another impact, a hand, the picture's
// edge. A block of ten frames must go on as those nearer to the contact do.
void Analysis::trim(FlightRange& range, bool before) const {
  constexpr std::size_t kBlock = 10;
  const double gravity = options_.gravity.value_or(0.0) * direction_.n;
  const auto level = [&](std::size_t first) {  // of the block that starts so far from the contact
    std::vector<double> steps;
    for (std::size_t k = first; k < first + kBlock; ++k) {
      const std::size_t i = before ? range.last - 1 - k : range.first + k;
      steps.push_back(series_.step_n[i] - gravity * (static_cast<double>(i) - range.at));
    }
    return upper_median(finite(steps));
  };
  const std::size_t count = range.last - range.first;
  for (std::size_t first = kBlock; first + kBlock <= count; first += kBlock) {
    const double near = level(first - kBlock), far = level(first);
    // Where gravity is unknown a flight's level may change; it does so slowly.
    if (std::isnan(far) || std::abs(far - near) <= 8 * guess_.step_noise + 0.05 * std::abs(near)) {
      continue;
    }
    (before ? range.first : range.last) = before ? range.last - first : range.first + first;
    return;
  }
}

// The surface's impulse must stand out of what flights under gravity alone would show.
bool Analysis::is_impact() const {
  if (!flights_.ok) return false;
  const auto& c = flights_.covariance;
  const double impulse = flights_.state[kVn1] - flights_.state[kVn0] -
                         flights_.gravity * direction_.n * (after_.at - before_.at);
  const double sd = std::sqrt(c(kVn0, kVn0) + c(kVn1, kVn1) - 2 * c(kVn0, kVn1));
  return flights_.state[kVn0] < 0 && flights_.state[kVn1] > 0 && impulse > kSignificant * sd &&
         impulse > kSignificant * guess_.step_noise / 2;
}

ContactEdge Analysis::edge(bool end, double near) const {
  EdgeRequest request;
  request.end = end;
  const int column = end ? kN1 : kN0;
  request.flight = {end ? after_.at : before_.at, flights_.state.segment<2>(column),
                    flights_.covariance.block<2, 2>(column, column)};
  request.gravity_n = flights_.gravity * direction_.n;
  request.turn = turn_.instant;
  request.guess = near;
  request.peak_acceleration = guess_.peak_acceleration;
  request.from = end ? after_.first : before_.last;
  request.position_scale = flights_.position_scale;
  request.step_scale = flights_.step_scale;
  return fit_edge(series_, request);
}

void Analysis::find_edges(double start_guess, double end_guess) {
  start_ = edge(false, start_guess);
  end_ = edge(true, end_guess);
  const double first = static_cast<double>(before_.first), last = static_cast<double>(after_.last);
  start_.ok = start_.ok && start_.instant > first && start_.instant < turn_.instant;
  end_.ok = end_.ok && end_.instant < last && end_.instant > turn_.instant;
}

// Flights up to the contact, and the edges once more; those known so far where that fails.
void Analysis::refit(double length) {
  struct Flights {
    FlightRange before, after;
    FlightFit fit;
  };
  const Flights known{before_, after_, flights_};
  // No farther than half a contact, though: an edge that is not known better bounds no flight.
  const double in = start_.instant - std::min(3 * start_.sd, length / 2) - 1;
  const double out = end_.instant + std::min(3 * end_.sd, length / 2) + 1;
  before_.at = start_.instant;
  after_.at = end_.instant;
  const auto first = static_cast<double>(before_.first + kFewestFlightFrames);
  const auto last = static_cast<double>(after_.last - kFewestFlightFrames);
  before_.last = static_cast<std::size_t>(std::max(std::floor(in), first));
  after_.first = static_cast<std::size_t>(std::min(std::ceil(out), last));
  limit_flights();
  fit_both();
  if (flights_.ok) {
    find_edges(start_.instant, end_.instant);
  } else {
    before_ = known.before, after_ = known.after, flights_ = known.fit;
  }
}

void Analysis::find_contact() {
  const double length = static_cast<double>(guess_.last - guess_.first);
  // Centres tell an acceleration worse than steps do.
  const double reach = length / (series_.from_circle ? 5 : 10);
  turn_ = fit_turn(series_, guess_.turn, std::max(4.0, reach), guess_.peak_acceleration,
                   flights_.position_scale, flights_.step_scale);
  if (!turn_.ok) turn_.instant = guess_.turn;
  if (!turn_.ok || guess_.last - guess_.first < kFewestContactFrames) {
    result_.status = ImpactStatus::kNotResolved;
    return;
  }
  find_edges(static_cast<double>(guess_.first), static_cast<double>(guess_.last));
  if (start_.ok && end_.ok) refit(length);
  if (!start_.ok || !end_.ok) result_.status = ImpactStatus::kNotResolved;
}

// Weighted mean of the turns, its deviation from their scatter and from what they may have in
// common.
Measured Analysis::spin(const FlightRange& range) const {
  std::vector<double> turns, sds;
  for (std::size_t i = range.first; i < range.last; ++i) {
    if (std::isfinite(series_.turn[i])) {
      turns.push_back(series_.turn[i]);
      sds.push_back(series_.turn_sd[i]);
    }
  }
  if (turns.size() < 3) return {};
  const double usual = upper_median(finite(sds)), centre = upper_median(finite(turns));
  std::vector<double> off;
  for (double turn : turns) off.push_back(std::abs(turn - centre));
  const double limit = 5 * kSdOfMad * upper_median(finite(off)) + 1e-12;
  double weights = 0, sum = 0, squares = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (std::abs(turns[i] - centre) > limit) continue;
    const double sd = sds[i] > 0 ? sds[i] : usual > 0 ? usual : 1.0;
    weights += 1 / (sd * sd), sum += (turns[i] - centre) / (sd * sd), ++count;
  }
  if (count < 3) return {};
  const double mean = centre + sum / weights;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (std::abs(turns[i] - centre) > limit) continue;
    const double sd = sds[i] > 0 ? sds[i] : usual > 0 ? usual : 1.0;
    squares += (turns[i] - mean) * (turns[i] - mean) / (sd * sd);
  }
  const double scatter_sq = squares / static_cast<double>(count - 1);
  const double common = common_share(std::sqrt(scatter_sq), count) * usual * usual;
  return {mean, std::sqrt(scatter_sq / weights + common)};
}

// From the flight before, carried on to `instant`, down to the turn: less the steps that were
// measured since, or the height of the centres there.
Measured Analysis::above_lowest(const ImpactSources& sources, const Instant& instant) const {
  const std::size_t from = before_.last;
  const auto to = static_cast<std::size_t>(std::floor(turn_.instant));
  const double g = flights_.gravity * direction_.n;
  if (series_.from_circle) {
    Measured depth = propagate(sources, [&](const ImpactSources::Vector& x) {
      const double since = instant(x) - before_.at;
      return x[kN0] + x[kVn0] * since + g * since * since / 2 - turn_.height;
    });
    depth.sd = std::hypot(depth.sd, turn_.height_sd);
    return depth;
  }
  double path = 0, variance = 0;
  for (std::size_t i = from; i < to; ++i) {
    path += series_.step_n[i];
    variance += std::pow(series_.step_sd[i] * flights_.step_scale, 2);
  }
  const double rest = turn_.instant - static_cast<double>(to);
  path -= (guess_.peak_acceleration + flights_.gravity * direction_.n) * rest * rest / 2;
  Measured depth = propagate(sources, [&](const ImpactSources::Vector& x) {
    const double since = static_cast<double>(from) - before_.at, touch = instant(x) - before_.at;
    const double flown = x[kVn0] * (touch - since) + g * (touch * touch - since * since) / 2;
    return flown - path;
  });
  if (!std::isfinite(path)) return {};
  depth.sd = std::sqrt(depth.sd * depth.sd + variance);
  return depth;
}

// What needs no edges: where the flights cross; and what follows from the touch.
void Analysis::place(const ImpactSources& s, bool timed) {
  const Instant crossing = [&](const ImpactSources::Vector& x) { return crossing_of(s, x); };
  result_.crossing = propagate(s, crossing);
  if (turn_.ok) {
    result_.turn = {turn_.instant, turn_.sd};
    result_.crossing_above_lowest = above_lowest(s, crossing);
  }
  const double since = s.value[kStart] - s.before.at;
  const auto at_touch = [&](int place, int speed, double pull) {
    return s.value[place] + s.value[speed] * since + s.gravity * pull * since * since / 2;
  };
  const double t = at_touch(kT0, kVt0, direction_.t), n = at_touch(kN0, kVn0, direction_.n);
  const double c = std::cos(options_.surface_angle_rad), up = std::sin(options_.surface_angle_rad);
  result_.touch_x = c * t - up * n;
  result_.touch_y = up * t + c * n;
  if (!timed) return;
  result_.start = {
      {start_.instant, start_.sd}, {start_.exponent, start_.exponent_sd}, start_.law_holds};
  result_.end = {{end_.instant, end_.sd}, {end_.exponent, end_.exponent_sd}, end_.law_holds};
  result_.duration =
      propagate(s, [](const ImpactSources::Vector& x) { return x[kEnd] - x[kStart]; });
  result_.max_deflection =
      above_lowest(s, [](const ImpactSources::Vector& x) { return x[kStart]; });
}

void Analysis::finish() {
  const bool timed = result_.status == ImpactStatus::kFound;
  ImpactSources s;
  s.before = before_, s.after = after_;
  s.direction = direction_;
  s.gravity = flights_.gravity;
  s.value.setZero();
  s.covariance.setZero();
  s.value.head<kFlightStates>() = flights_.state;
  s.covariance.topLeftCorner<kFlightStates, kFlightStates>() = flights_.covariance;
  const auto put = [&](int i, double value, double sd) {
    s.value[i] = value;
    s.covariance(i, i) = std::isfinite(sd) ? sd * sd : 0.0;
  };
  // A contact that was not resolved is taken for an instant, known to its guessed length.
  const double unresolved = static_cast<double>(guess_.last - guess_.first) / 2;
  put(kStart, timed ? start_.instant : turn_.instant, timed ? start_.sd : unresolved);
  put(kEnd, timed ? end_.instant : turn_.instant, timed ? end_.sd : unresolved);
  const Measured spin0 = spin(before_), spin1 = spin(after_);
  put(kSpin0, spin0.value, spin0.sd);
  put(kSpin1, spin1.value, spin1.sd);
  fill_figures(s, options_, result_);
  place(s, timed);
  const FlightFit fall = fit_flights(series_, before_, after_, direction_, std::nullopt);
  if (fall.ok) result_.fall = {fall.gravity, fall.gravity_sd};
  result_.position_scatter = flights_.position_scale;
  result_.step_scatter = flights_.step_scale;
  result_.disagreement = flights_.disagreement;
}

}  // namespace

}  // namespace impactdic::impact

namespace impactdic {

const char* to_string(ImpactStatus status) {
  constexpr std::array kWords = {"found", "none", "wrong_side", "flight_too_short", "not_resolved"};
  return kWords[static_cast<std::size_t>(status)];
}

const char* to_string(ClosureVerdict verdict) {
  constexpr std::array kWords = {"undetermined", "closes", "signs", "lever_arm", "scale"};
  return kWords[static_cast<std::size_t>(verdict)];
}

}  // namespace impactdic

namespace impactdic::impact {

ImpactAnalysis analyse_impact(const std::vector<TrackRow>& rows, const ImpactOptions& options) {
  ImpactAnalysis result = Analysis(rows, options).run();
  if (result.status != ImpactStatus::kNone) return result;
  ImpactOptions turned = options;
  turned.surface_angle_rad += kPi;
  const ImpactStatus other = Analysis(rows, turned).run().status;
  if (other == ImpactStatus::kFound || other == ImpactStatus::kNotResolved) {
    result.status = ImpactStatus::kWrongSide;
  }
  return result;
}

}  // namespace impactdic::impact
