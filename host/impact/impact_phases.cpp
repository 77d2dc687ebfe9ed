#include "host/impact/impact_phases.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <tuple>

#include "host/base/parallel/parallel_for.h"
#include "host/base/statistics.h"
#include "host/impact/analysis.h"
#include "host/impact/evidence/more_impacts.h"
#include "host/impact/evidence/path_evidence.h"
#include "host/impact/evidence/sparse_flights.h"
#include "host/impact/flight_spin.h"
#include "host/impact/space/space_impact.h"
#include "host/impact/whole_flight.h"

namespace impactdic::impact {
namespace {

constexpr std::size_t kFewestContactFrames = 8;
constexpr int kMoreGuards = 3;
constexpr double kSignificant = 3;  // deviations that an impulse must stand out by
// Logarithm of the odds: the sharpest of some hundred places, and two flights under one gravity.
constexpr double kEvident = 7, kAsLikely = 0;

}  // namespace

Analysis::Analysis(const TrackRows& rows, const ImpactOptions& options)
    : rows_(rows),
      options_(options),
      series_(rows, options.surface_angle_rad, known_of_sphere(options)) {
  const double angle = options.gravity_angle_rad - options.surface_angle_rad;
  direction_ = {std::cos(angle), std::sin(angle)};
}

ImpactAnalysis Analysis::run() {
  set_radius(free_radius(rows_));
  guess_ = guess_contact(series_, options_.gravity.value_or(0.0) * direction_.n);
  if (!guess_.found) return result_;
  bool long_enough = set_flights();
  if (!long_enough) guess_ = sharpened(series_, guess_), long_enough = set_flights();
  if (!is_evident(long_enough, kEvident)) return result_;
  if (!long_enough) {
    set_radius(free_radius(rows_, {0, guess_.first - std::min(guess_.first, kLeastGuard), 0},
                           {guess_.last + kLeastGuard, series_.size() - 1, 0}));
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

ImpactAnalysis Analysis::run_sparse() {
  series_.use_centres();
  for (const SparseBounce& bounce : sparse_bounces(series_, direction_.n)) {
    before_ = bounce.before, after_ = bounce.after;
    guess_.first = before_.last, guess_.last = after_.first;
    turn_.instant = before_.at;
    fit_both();
    if (!is_evident(true, kAsLikely) || !is_impact()) continue;
    // A ball that is pressed in by a third of its radius is so for that long, roughly.
    contact_ = std::min(static_cast<double>(guess_.last - guess_.first),
                        free_radius(rows_, before_, after_).px.value / -flights_.state[kVn0]);
    result_.status = ImpactStatus::kNotResolved;
    finish();
    break;
  }
  return result_;
}

ImpactAnalysis Analysis::run_centres() {
  series_.use_centres();
  if (!is_found(run()) || !series_.is_motion_lost(before_.first, after_.last)) return {};
  return result_;
}

bool Analysis::set_flights() {
  const std::size_t last_row = series_.size() - 1;
  const std::size_t guard = guard_of(guess_, last_row);
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
  const double gravity = options_.gravity.value_or(0.0) * direction_.n;
  before_ = trimmed(series_, guess_, before_, true, gravity);
  after_ = trimmed(series_, guess_, after_, false, gravity);
  return true;
}

void Analysis::limit_flights() {
  const auto longest = static_cast<std::size_t>(
      std::max(options_.flight_frames, static_cast<int>(kFewestFlightFrames)));
  before_.first = std::max(before_.first, before_.last - std::min(before_.last, longest));
  after_.last = std::min(after_.last, after_.first + longest);
}

bool Analysis::is_evident(bool with_flights, double odds) const {
  if (options_.impact_is_known) return true;
  const auto longest = static_cast<std::size_t>(options_.flight_frames);
  PathSpan span = {guess_.first, guess_.last, guess_.first - std::min(guess_.first, longest),
                   std::min(guess_.last + longest, series_.size() - 1)};
  if (with_flights) span.begin = before_.first, span.end = after_.last;
  return odds_of_contact(series_, span, options_.path_sd_px) >
         (options_.impact_is_expected ? kAsLikely : odds);
}

// The surface's impulse must stand out of what gravity alone would show.
bool Analysis::is_impact() const {
  if (!flights_.ok) return false;
  const auto& c = flights_.covariance;
  const double impulse = flights_.state[kVn1] - flights_.state[kVn0] -
                         flights_.gravity * direction_.n * (after_.at - before_.at);
  const double sd = std::sqrt(c(kVn0, kVn0) + c(kVn1, kVn1) - 2 * c(kVn0, kVn1));
  return flights_.state[kVn0] < 0 && flights_.state[kVn1] > 0 && impulse > kSignificant * sd;
}

ContactEdge Analysis::edge(bool end, double near, bool likeliest_alone) const {
  const int column = end ? kN1 : kN0;
  EdgeRequest request{.end = end,
                      .gravity_n = flights_.gravity * direction_.n,
                      .turn = turn_.instant,
                      .guess = near,
                      .peak_acceleration = guess_.peak_acceleration,
                      .from = end ? after_.first : before_.last,
                      .position_scale = flights_.position_scale,
                      .step_scale = flights_.step_scale,
                      .likeliest_alone = likeliest_alone};
  request.flight = {end ? after_.at : before_.at, flights_.state.segment<2>(column),
                    flights_.covariance.block<2, 2>(column, column)};
  return fit_edge(series_, request);
}

// Frames for a change of gravity, px/frame^2, which bends the flight that the edge is found on.
double Analysis::edge_per_gravity(bool end) const {
  constexpr double kStep = 0.05;  // of gravity
  const ContactEdge& known = end ? end_ : start_;
  const double change = kStep * flights_.gravity;
  double instants[2] = {};
  for (const int side : {0, 1}) {
    Analysis other = *this;
    other.flights_.gravity += side == 0 ? -change : change;
    other.flights_.state += flights_.per_gravity * (other.flights_.gravity - flights_.gravity);
    const ContactEdge found = other.edge(end, known.instant, true);
    if (!found.ok || found.reach != known.reach) return 0;  // another fit: no slope
    instants[side] = found.instant;
  }
  return (instants[1] - instants[0]) / (2 * change);
}

void Analysis::find_edges(double start_guess, double end_guess) {
  parallel_for(2, [&](std::size_t end) {
    (end ? end_ : start_) = edge(end > 0, end > 0 ? end_guess : start_guess, false);
  });
  const double first = static_cast<double>(before_.first), last = static_cast<double>(after_.last);
  start_.ok = start_.ok && start_.instant > first && start_.instant < turn_.instant;
  end_.ok = end_.ok && end_.instant < last && end_.instant > turn_.instant;
}

// A flight that begins before the contact is over leaves its end no place: once more, a guard
// later.
bool Analysis::back_off() {
  const std::size_t guard = guard_of(guess_, series_.size() - 1);
  FlightRange before = before_, after = after_;
  if (!start_.ok) before.last -= std::min(before.last, guard);
  if (!end_.ok) after.first += guard;
  if (before.last < before.first + kFewestFlightFrames ||
      after.last < after.first + kFewestFlightFrames) {
    return false;
  }
  const auto known = std::tuple(before_, after_, flights_);
  before_ = before, after_ = after;
  fit_both();
  if (!flights_.ok) {
    std::tie(before_, after_, flights_) = known;
    return false;
  }
  find_edges(static_cast<double>(guess_.first), static_cast<double>(guess_.last));
  return true;
}

// Flights up to the contact, and the edges once more; those known so far where that fails.
void Analysis::refit(double length) {
  const auto known = std::tuple(before_, after_, flights_);
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
    std::tie(before_, after_, flights_) = known;
  }
}

void Analysis::find_contact() {
  const double length = contact_ = static_cast<double>(guess_.last - guess_.first);
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
  for (int k = 0; k < kMoreGuards && !(start_.ok && end_.ok) && back_off();) ++k;
  if (start_.ok && end_.ok) refit(length);
  // One that may as well lie behind the turn was not found.
  start_.ok = start_.ok && start_.instant + start_.sd < turn_.instant;
  end_.ok = end_.ok && end_.instant - end_.sd > turn_.instant;
  if (!start_.ok || !end_.ok) result_.status = ImpactStatus::kNotResolved;
}

void Analysis::set_radius(const FreeRadius& radius) {
  if (radius.frames == 0) return;
  result_.radius_px = options_.radius_px.value_or(radius.px);
  result_.radius_frames = radius.frames;
  result_.radius_drift_px = radius.drift;
}

// From the flight before, carried on to `instant`, down to the turn: less the steps measured since,
// or the height of the centres there. Turned axes see a part of the way along the surface, too.
Propagated Analysis::above_lowest(const ImpactSources& sources, const Instant& instant) const {
  using Vector = ImpactSources::Vector;
  const std::size_t from = before_.last;
  const auto to = static_cast<std::size_t>(std::floor(turn_.instant));
  const auto pull = [&](const Vector& x) { return x[kGravity] * direction_.n; };
  if (series_.from_circle) {
    Propagated depth = propagate(sources, [&](const Vector& x) {
      const double since = instant(x) - before_.at;
      return x[kN0] + x[kVn0] * since + pull(x) * since * since / 2 - turn_.height;
    });
    depth.add(ErrorSource::kNoise, turn_.height_sd);
    return depth;
  }
  double path_n = 0, path_t = 0, variance = 0;
  for (std::size_t i = from; i < to; ++i) {
    path_n += series_.step_n[i];
    path_t += series_.step_t(i);
    variance += std::pow(series_.step_sd(i) * flights_.step_scale, 2);
  }
  const double rest = turn_.instant - static_cast<double>(to);
  path_n -= (guess_.peak_acceleration + flights_.gravity * direction_.n) * rest * rest / 2;
  if (std::isfinite(series_.step_t(to))) path_t += rest * series_.step_t(to);
  Propagated depth = propagate(sources, [&](const Vector& x) {
    const double since = static_cast<double>(from) - before_.at, touch = instant(x) - before_.at;
    const double square = (touch * touch - since * since) / 2;
    const double flown_n = x[kVn0] * (touch - since) + pull(x) * square;
    const double flown_t = x[kVt0] * (touch - since);
    return std::cos(x[kAngle]) * (flown_n - path_n) - std::sin(x[kAngle]) * (flown_t - path_t);
  });
  if (!std::isfinite(path_n)) return {};
  depth.add(ErrorSource::kNoise, std::sqrt(variance));
  return depth;
}

// What needs no edges: where the flights cross; and what follows from the touch.
void Analysis::place(const ImpactSources& s, bool timed) {
  const Instant crossing = [&](const ImpactSources::Vector& x) { return crossing_of(s, x); };
  result_.crossing = propagate(s, crossing).measured;
  if (turn_.ok) {
    result_.turn = {turn_.instant, turn_.sd};
    result_.crossing_above_lowest = above_lowest(s, crossing).measured;
  } else {  // somewhere in the contact
    result_.turn = {result_.crossing.value, std::hypot(result_.crossing.sd, contact_ / 4)};
  }
  const double since = s.value[kStart] - s.before.at;
  const auto at_touch = [&](int place, int speed, double pull) {
    return s.value[place] + s.value[speed] * since + s.gravity() * pull * since * since / 2;
  };
  const double t = at_touch(kT0, kVt0, direction_.t), n = at_touch(kN0, kVn0, direction_.n);
  const double c = std::cos(options_.surface_angle_rad), up = std::sin(options_.surface_angle_rad);
  result_.touch_x = c * t - up * n;
  result_.touch_y = up * t + c * n;
  if (start_.ok) result_.start = start_.result();
  if (end_.ok) result_.end = end_.result();
  if (!timed) return;
  result_.duration =
      noted(result_, ImpactFigure::kContactDuration,
            propagate(s, [](const ImpactSources::Vector& x) { return x[kEnd] - x[kStart]; }));
  result_.max_deflection =
      noted(result_, ImpactFigure::kMaxDeflection,
            above_lowest(s, [](const ImpactSources::Vector& x) { return x[kStart]; }));
}

ImpactSources Analysis::sources(bool timed) const {
  ImpactSources s;
  s.before = before_, s.after = after_;
  s.direction = direction_;
  s.value.head<kFlightStates>() = flights_.state;
  const auto part = [&](ErrorSource kind) -> auto& {
    return s.covariance[static_cast<std::size_t>(kind)];
  };
  part(ErrorSource::kNoise).topLeftCorner<kFlightStates, kFlightStates>() =
      flights_.covariance - flights_.common;
  part(ErrorSource::kCircle).topLeftCorner<kFlightStates, kFlightStates>() = flights_.common;
  // A contact that was not resolved is taken for an instant, known to its guessed length.
  s.value[kStart] = timed ? start_.instant : turn_.instant;
  s.value[kEnd] = timed ? end_.instant : turn_.instant;
  s.add(ErrorSource::kContact, kStart, timed ? start_.sd : contact_ / 2);
  s.add(ErrorSource::kContact, kEnd, timed ? end_.sd : contact_ / 2);
  const FlightSpin spin0 = flight_spin(series_, before_), spin1 = flight_spin(series_, after_);
  s.value[kSpin0] = spin0.value, s.value[kSpin1] = spin1.value;
  s.add(ErrorSource::kNoise, kSpin0, spin0.noise_sd);
  s.add(ErrorSource::kNoise, kSpin1, spin1.noise_sd);
  s.add(ErrorSource::kCircle, kSpin0, spin0.common_sd);
  s.add(ErrorSource::kCircle, kSpin1, spin1.common_sd);
  s.add(ErrorSource::kCircle, kSpin0, tilted_spin_sd(flights_, kSpinT0));
  s.add(ErrorSource::kCircle, kSpin1, tilted_spin_sd(flights_, kSpinT1));
  s.value[kRadius] = result_.radius_px.value;
  s.add(ErrorSource::kCircle, kRadius, result_.radius_px.sd);
  s.add(ErrorSource::kAngle, kAngle, options_.surface_angle_sd_rad);
  s.value[kGravity] = flights_.gravity;
  s.per_gravity.head<kFlightStates>() = flights_.per_gravity;
  s.per_gravity[kGravity] = 1;
  if (timed && options_.gravity && *options_.gravity > 0) {
    s.per_gravity[kStart] = edge_per_gravity(false);
    s.per_gravity[kEnd] = edge_per_gravity(true);
  }
  return s;
}

void Analysis::finish() {
  const bool timed = result_.status == ImpactStatus::kFound;
  set_radius(free_radius(rows_, before_, after_));
  const ImpactSources s = sources(timed);
  fill_figures(s, options_, result_);
  put_out_of_plane(flights_, rows_, options_, result_);
  place(s, timed);
  const FlightFit fall = fit_flights(series_, before_, after_, direction_, std::nullopt);
  if (fall.ok) {
    result_.fall = {fall.gravity, fall.gravity_sd};
    result_.fall_across = fall_across(series_, before_, after_, direction_, fall.gravity);
  }
  result_.position_scatter = flights_.position_scale;
  result_.step_scatter = flights_.step_scale;
  result_.disagreement = flights_.disagreement;
}

ImpactAnalysis impact_on_this_side(const TrackRows& rows, const ImpactOptions& options) {
  ImpactAnalysis result = Analysis(rows, options).run();
  for (const auto other : {&Analysis::run_sparse, &Analysis::run_centres}) {
    if (is_found(result)) break;
    const ImpactAnalysis by_centres = (Analysis(rows, options).*other)();
    if (is_found(by_centres)) result = by_centres;
  }
  if (is_found(result)) result.space = space_impact(options, result);
  return result;
}

ImpactAnalysis analyse_impact(const TrackRows& rows, const ImpactOptions& options) {
  ImpactAnalysis result = Analysis(rows, options).run();
  if (!is_found(result)) {
    // A long clip without an impact asks for all of them, and none waits for another.
    ImpactOptions turned = options;
    turned.surface_angle_rad += kPi;
    ImpactAnalysis sparse, by_centres, on_other_side;
    const std::array<std::function<void()>, 3> others = {
        [&] { sparse = Analysis(rows, options).run_sparse(); },
        [&] { by_centres = Analysis(rows, options).run_centres(); },
        [&] { on_other_side = Analysis(rows, turned).run(); }};
    parallel_for(others.size(), [&](std::size_t i) { others[i](); });
    if (is_found(sparse)) {
      result = sparse;
    } else if (is_found(by_centres)) {
      result = by_centres;
    } else if (result.status == ImpactStatus::kNone) {
      if (is_found(on_other_side)) {
        result.status = ImpactStatus::kWrongSide;
      } else {
        result.flight = whole_flight(rows, options);
      }
    }
  }
  if (is_found(result)) result.space = space_impact(options, result);
  return result;
}

}  // namespace impactdic::impact
