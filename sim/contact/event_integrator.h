// The one integrator of impacts, of balls and of rods: an adaptive Dormand-Prince 5(4)
// (Boost.odeint) through a sequence of modes that end at events.
//
// Every switch of a mode is the root of a guard, found on single Runge-Kutta steps from the last
// accepted state, so that a switch is as exact as the method; the integration restarts there. The
// search begins at the root of the step's interpolant, which is near but not as exact; where that
// does not lead there TOMS 748 does (Alefeld, Potra and Shi 1995).
#pragma once

#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "sim/contact/numbers/real.h"
#include "sim/contact/numbers/step_adjuster.h"

namespace impactdic::sim::contact {

template <typename State>
struct EventInstant {
  typename State::value_type time_s{};
  State x{}, rate{};
};

struct EventLimits {
  double longest_s = 0;       // of the whole integration
  double longest_step_s = 0;  // 0: as the tolerance allows
  double negligible_s = 0;    // a part of a step so short is exact whatever the error estimate says
  int most_switches = 0;
  long most_steps = 0;
  const char* hint = "";  // of the errors
};

// A system with modes and guards. It has the types and members that are used below:
//   State; kMostGuards
//   rates(x, rate)          the right-hand side in the present mode
//   guards(x, values)       fills the functions that are positive while the mode lasts, returns
//                           their number; one that falls through zero ends the mode
//   switch_mode(guard, time_s, x)    may correct x by less than the tolerance
//   finished()              asked after every step and switch
//   accepted(instant, stretch_s, state_within)   told of every step; state_within(s) is the state s
//                           after the step before it began, which lasted stretch_s up to here
//   next_point_s(), take_point(time_s, x)         the points that the caller wants, ascending
//   restart_step_s(step_s)  first step of the next mode, where the last mode's would be step_s
// Where its numbers have derivatives, also
//   fixed_guard(x)   the guard whose value is to keep none from step to step; below zero: no such
//   hold(guard)      told which, so that it may keep none within steps either
//   keep_time(time_s, x)   adds to the time what holding it has moved the instant by
//   just_before(guard, x)   the state a little before it crosses
// The derivatives are those at instants that move with the inputs as the last event does.
// ErrorChecker: as odeint's controlled_runge_kutta takes it.
template <typename System, typename ErrorChecker>
class EventIntegrator {
 public:
  using State = typename System::State;
  using Real = typename State::value_type;
  using Instant = EventInstant<State>;
  using Dopri5 = boost::numeric::odeint::runge_kutta_dopri5<State>;
  using Stepper =
      boost::numeric::odeint::controlled_runge_kutta<Dopri5, ErrorChecker, StepAdjuster>;

  EventIntegrator(System& system, const ErrorChecker& checker, const EventLimits& limits,
                  const Real& start_s, const State& start)
      : system_(system),
        limits_(limits),
        start_s_(value_of(start_s)),
        checker_(checker),
        stepper_(checker, typename Stepper::step_adjuster_type(limits.longest_step_s)) {
    now_.time_s = start_s;
    now_.x = start;
  }

  // Goes on until the system has finished or the longest time is over. Throws Error where no step
  // is small enough, modes chatter or steps make no progress.
  void run(double first_step_s) {
    double step_s = first_step_s;
    while (in_time()) {
      now_.rate = now_.x;
      system_.rates(now_.x, now_.rate);
      previous_ = now_;
      now_guards_ = guards(now_.x);
      // A guard that starts at zero was just crossed, or begins there: it counts only once it has
      // been positive.
      first_of_mode_ = true;
      bool switched = false;
      while (!switched && in_time()) switched = advance(step_s);
      step_s = shorten_where_stalled(system_.restart_step_s(step_s));
    }
  }

  const Instant& now() const { return now_; }
  long steps() const { return steps_; }

 private:
  struct GuardValues {
    std::array<Real, System::kMostGuards> value{};
    int count = 0;
  };

  // The right-hand side in the form that odeint calls.
  auto right_side() const {
    return [this](const State& x, State& rate, double) { system_.rates(x, rate); };
  }
  bool in_time() const {
    return !system_.finished() && value_of(now_.time_s) - start_s_ < limits_.longest_s;
  }
  GuardValues guards(const State& x) const {
    GuardValues guards;
    guards.count = system_.guards(x, guards.value);
    return guards;
  }

  // The stepper asks for the rate at the step's end as well, as its sixth: nobody looks at it here.
  State single_step(const Instant& from, double step_s) {
    State x = from.x, rate = from.x;
    const auto stages = [this, asked = 0](const State& at, State& to, double) mutable {
      if (++asked < 6) system_.rates(at, to);
    };
    rk_.do_step(stages, from.x, from.rate, value_of(from.time_s), x, rate, step_s);
    return x;
  }

  // The part of a step up to an event; nothing where it does not meet the tolerance by itself. The
  // whole step did, but its stages may have passed by a rate that changes fast just before the
  // event.
  std::optional<State> exact_part(double step_s) {
    State x = now_.x, rate = now_.x, error = now_.x;
    rk_.do_step(right_side(), now_.x, now_.rate, value_of(now_.time_s), x, rate, step_s, error);
    const bool exact = step_s < limits_.negligible_s ||
                       checker_.error(rk_.algebra(), now_.x, now_.rate, error, step_s) <= 1;
    return exact ? std::optional(x) : std::nullopt;
  }

  Instant try_steps(double& step_s) {
    Instant next{now_.time_s, now_.x, now_.x};
    double time_s = value_of(now_.time_s);
    for (int failures = 0; stepper_.try_step(right_side(), now_.x, now_.rate, time_s, next.x,
                                             next.rate, step_s) == boost::numeric::odeint::fail;) {
      if (++failures > 500) throw Error("the step size vanishes", "integration", limits_.hint);
    }
    next.time_s = later(now_.time_s, time_s);
    return next;
  }

  State within(const Instant& next, double time_s) {
    State x = now_.x;
    stepper_.stepper().calc_state(time_s, x, now_.x, now_.rate, value_of(now_.time_s), next.x,
                                  next.rate, value_of(next.time_s));
    return x;
  }

  // One step, or the part of it up to the first event. Returns whether a mode has changed.
  bool advance(double& step_s) {
    Instant next = try_steps(step_s);
    const double begin_s = value_of(now_.time_s), taken = value_of(next.time_s) - begin_s;
    const GuardValues middle = guards(within(next, begin_s + 0.5 * taken));
    GuardValues end = guards(next.x);
    if (first_of_mode_) {
      first_of_mode_ = false;
      if (leave_at_once(middle, end)) return true;
    }
    const Event event = first_event(next, middle, end);
    if (event.guard < 0) {
      hand_over(next, false);
      keep_fixed(next, end);
      accept(next);
      now_guards_ = end;
      return false;
    }
    const std::optional<State> part = exact_part(event.after_s);
    if (!part) {
      step_s = 0.5 * event.after_s;
      return false;
    }
    Instant at_event{later(now_.time_s, begin_s + event.after_s), *part, {}};
    hand_over(at_event, true);
    if constexpr (kHasDerivatives<Real>) {
      system_.keep_time(at_event.time_s, at_event.x);
      move_onto(event.guard, at_event);
    }
    accept(at_event);
    switch_mode(event.guard);
    if (!system_.finished()) keep_fixed(now_, now_guards_);
    step_s = std::min(step_s, taken);
    return true;
  }

  // Moves an instant with the inputs so that the guard's value keeps its own whatever they do.
  void move_onto(int guard, Instant& at) requires kHasDerivatives<Real> {
    system_.rates(system_.just_before(guard, at.x), at.rate);
    State along = at.x;
    for (std::size_t i = 0; i < along.size(); ++i) along[i].v[kByTime] = at.rate[i].a;
    const Real value = guards(along).value[guard];
    auto wait = (-value.v / value.v[kByTime]).eval();
    wait[kByTime] = 0;
    for (std::size_t i = 0; i < along.size(); ++i) at.x[i].v += at.rate[i].a * wait;
    at.time_s.v += wait;
    system_.rates(at.x, at.rate);
  }

  // Near the end of a contact its force is like a power of the way that is left, and too steep for
  // derivatives of that way.
  void keep_fixed(Instant& next, GuardValues& end) {
    if constexpr (kHasDerivatives<Real>) {
      system_.keep_time(next.time_s, next.x);
      const int guard = system_.fixed_guard(next.x);
      system_.hold(guard);
      if (guard < 0) return;
      move_onto(guard, next);
      end = guards(next.x);
    }
  }

  // A mode whose guard is never positive was wrong from its start: the next one takes its place
  // there.
  bool leave_at_once(const GuardValues& middle, const GuardValues& end) {
    for (int i = 0; i < end.count; ++i) {
      if (now_guards_.value[i] > 0 || middle.value[i] > 0 || end.value[i] > 0) continue;
      ++at_once_;
      switch_mode(i);
      return true;
    }
    return false;
  }

  // Modes that replace each other at one instant were judged by too long a step: a guard rises from
  // zero and is below it again before the step's middle. Each time the step is ten times shorter.
  double shorten_where_stalled(double step_s) const {
    constexpr int kUsual = 2;  // one mode gives way to another, which may be wrong as well
    if (at_once_ <= kUsual) return step_s;
    return std::max(step_s * std::pow(0.1, at_once_ - kUsual), limits_.negligible_s);
  }

  struct Event {
    int guard = -1;  // none
    double after_s = 0;
  };
  // Where a law jumps all guards that look at it fall together. Then the first in the system's
  // order counts, and the others are judged behind the jump.
  Event first_event(const Instant& next, const GuardValues& middle, const GuardValues& end) {
    Event first{-1, value_of(next.time_s) - value_of(now_.time_s)};
    for (int i = 0; i < end.count; ++i) {
      const double root = guard_root(i, next, value_of(middle.value[i]), value_of(end.value[i]));
      const double apart = first.guard < 0 ? 0 : limits_.negligible_s;
      if (root < first.after_s - apart) first = {i, root};
    }
    return first;
  }

  // The time from now_ at which guard i falls through zero, infinite if it does not.
  double guard_root(int i, const Instant& next, double middle, double end) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const double taken = value_of(next.time_s) - value_of(now_.time_s);
    const double begin = value_of(now_guards_.value[i]);
    double low = 0, high = taken;
    if (begin > 0 && middle <= 0) {
      high = 0.5 * taken;
    } else if (middle > 0 && end <= 0) {
      low = 0.5 * taken;
    } else {
      return kNever;
    }
    const double near = root_by_interpolant(
        i, next, {low, low > 0 ? middle : begin, high, high < taken ? middle : end});
    if (near >= 0) return near;
    const auto value = [&](double step) {
      return value_of(guards(single_step(now_, step)).value[i]);
    };
    const double low_value = low > 0 ? value(low) : begin;
    double high_value = value(high);
    if (high_value > 0 && high < taken) high_value = value(high = taken);
    if (!(low_value > 0)) {  // the interpolant and the step differ by rounding: it is there
      return begin > 0 ? low : kNever;
    }
    if (high_value > 0) return kNever;
    if (high_value == 0) return high;
    std::uintmax_t iterations = 100;
    const auto close = [taken](double a, double b) { return std::abs(b - a) <= kSame * taken; };
    return boost::math::tools::toms748_solve(value, low, high, low_value, high_value, close,
                                             iterations)
        .second;
  }

  // Where two signs differ.
  struct Bracket {
    double low = 0, low_value = 0, high = 0, high_value = 0;
  };

  // The same from the root of the interpolant, which asks for no right-hand side, by one step of
  // Newton's method with the interpolant's slope and one of the secant. Below zero where they do
  // not close in on the root.
  double root_by_interpolant(int i, const Instant& next, const Bracket& in) {
    constexpr double kNone = -1;
    if (!(in.low_value > 0) || !(in.high_value < 0)) return kNone;
    const double begin_s = value_of(now_.time_s), taken = value_of(next.time_s) - begin_s;
    const auto guess = [&](double after) {
      return value_of(guards(within(next, begin_s + after)).value[i]);
    };
    std::uintmax_t iterations = 30;
    const auto close = [taken](double a, double b) { return std::abs(b - a) <= 1e-5 * taken; };
    const auto [a, b] = boost::math::tools::toms748_solve(guess, in.low, in.high, in.low_value,
                                                          in.high_value, close, iterations);
    const auto value = [&](double after) {
      return value_of(guards(single_step(now_, after)).value[i]);
    };
    const double first = 0.5 * (a + b), aside = 1e-3 * taken;
    const double left = std::max(first - aside, in.low), right = std::min(first + aside, in.high);
    const double slope = (guess(right) - guess(left)) / (right - left);
    const double first_value = value(first), second = first - first_value / slope;
    if (!(second > in.low && second < in.high)) return kNone;
    const double second_value = value(second);
    const double third = second - second_value * (second - first) / (second_value - first_value);
    const double error = std::abs((third - second) * (third - first));
    const double exact_s = kSame * taken;
    if (!(error <= exact_s * taken && third > in.low && third < in.high)) return kNone;
    // What jumps there must be seen from its far side.
    double after = third;
    for (double beyond = exact_s; beyond < 1e6 * exact_s; beyond *= 4) {
      if (value(after) <= 0) return after;
      after = third + beyond;
    }
    return kNone;
  }

  // Hands over the points that were asked for up to `next`. Within a whole step they come from the
  // dense output; within a part of one from single steps, since the interpolant of the whole step
  // has seen the far side of the switch.
  void hand_over(const Instant& next, bool part) {
    const double begin_s = value_of(now_.time_s), end_s = value_of(next.time_s);
    for (double t = system_.next_point_s(); t <= end_s; t = system_.next_point_s()) {
      system_.take_point(later(now_.time_s, t),
                         part ? single_step(now_, t - begin_s) : within(next, t));
    }
  }

  void accept(const Instant& next) {
    if (++steps_ > limits_.most_steps) throw Error("no progress", "integration", limits_.hint);
    system_.accepted(next, value_of(next.time_s) - value_of(previous_.time_s),
                     [this](double s) { return single_step(previous_, s); });
    previous_ = now_;
    now_ = next;
    at_once_ = 0;
  }

  void switch_mode(int guard) {
    if (++switches_ > limits_.most_switches) {
      throw Error("the contact's modes chatter", "integration", limits_.hint);
    }
    system_.switch_mode(guard, now_.time_s, now_.x);
  }

  static constexpr double kSame = 1e-15;  // two instants in parts of a step

  System& system_;
  const EventLimits limits_;
  double start_s_;
  ErrorChecker checker_;
  Stepper stepper_;
  Dopri5 rk_;
  Instant now_, previous_;
  GuardValues now_guards_;
  bool first_of_mode_ = false;
  int switches_ = 0;
  int at_once_ = 0;  // modes left since the last step
  long steps_ = 0;
};

}  // namespace impactdic::sim::contact
