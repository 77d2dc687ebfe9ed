#include "sim/contact/contact_integration.h"

#include <impactdic/error.h>

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "sim/contact/contact_record.h"
#include "sim/contact/step_control.h"

namespace impactdic::sim::contact {

namespace {

namespace odeint = boost::numeric::odeint;

struct AcceptedStep {
  double time_s = 0;
  ImpactState x{}, rate{};
};

class Integration {
 public:
  Integration(const ImpactJob& job, const NormalLaw& normal, FrictionLaw& friction,
              ContactDynamics& dynamics, double start_s, const ImpactState& start,
              TrajectoryRequest& request)
      : job_(job),
        normal_(normal),
        friction_(friction),
        dynamics_(dynamics),
        request_(request),
        start_s_(start_s),
        touch_((dynamics.memory = NormalMemory{}, dynamics.contact_point(start))),
        scales_(contact_scales(job, normal, touch_, start)),
        next_kink_m_(normal.next_kink_m(0)),
        checker_(job.solver.relative_tolerance, scales_.state),
        stepper_(checker_),
        record_(start_s, dynamics.normal_force_n(touch_)) {
    now_.time_s = start_s;
    now_.x = start;
  }

  ContactOutcome run() {
    friction_.begin(touch_);
    enter(PhaseKind::kNormal, "compression");
    enter(PhaseKind::kTangential, friction_.mode());
    double step_s = 1e-3 * scales_.duration_s;
    const double longest_s = 200 * scales_.duration_s;
    while (!done_ && now_.time_s - start_s_ < longest_s) {
      dynamics_(now_.x, now_.rate, now_.time_s);
      previous_ = now_;
      arm_guards();
      while (!advance(step_s) && now_.time_s - start_s_ < longest_s) {
      }
    }
    return record_.finish(done_, {now_.time_s, &now_.x}, dynamics_.contact_point(now_.x), dynamics_,
                          normal_, friction_);
  }

 private:
  // The guards are the normal law's, then the friction law's.
  enum NormalGuard { kTurn, kSeparation, kReload, kKink, kNormalGuards };
  static constexpr int kMostSwitches = 10000;  // of one contact; a sound one has a dozen
  static constexpr long kMostSteps = 2000000;
  static constexpr int kGuards = kNormalGuards + FrictionLaw::kMaxGuards;
  struct GuardValues {
    std::array<double, kGuards> value;
    int count;
  };

  // Positive while the mode lasts; a guard of another phase stays at 1.
  GuardValues guards(const ImpactState& x) const {
    const ContactPoint at = dynamics_.contact_point(x);
    GuardValues guards{};
    const NormalMemory& memory = dynamics_.memory;
    guards.value[kTurn] = memory.compressing ? at.rate_m_s : -at.rate_m_s;
    guards.value[kSeparation] = 1;
    guards.value[kReload] = 1;
    guards.value[kKink] = 1;
    if (!memory.compressing) {
      switch (job_.contact.restitution_damping) {
        case RestitutionDamping::kToZeroForce:
          guards.value[kSeparation] = dynamics_.normal_force_n(at);
          break;
        case RestitutionDamping::kToZeroDeflection:
          guards.value[kSeparation] = at.deflection_m;
          break;
        case RestitutionDamping::kNone:
          guards.value[kSeparation] = at.deflection_m - memory.residual_m;
          break;
      }
    } else if (memory.unloading) {
      guards.value[kReload] = memory.max_deflection_m - at.deflection_m;
    } else {
      guards.value[kKink] = next_kink_m_ - at.deflection_m;
    }
    FrictionLaw::Guards friction;
    const int count = friction_.guards(at, friction);
    std::copy_n(friction.begin(), count, guards.value.begin() + kNormalGuards);
    guards.count = kNormalGuards + count;
    return guards;
  }

  // A guard that starts at zero was just crossed, or begins there: it counts only once it has been
  // positive.
  void arm_guards() {
    now_guards_ = guards(now_.x);
    first_of_segment_ = true;
  }

  // A mode whose guard is never positive was wrong from its start: the next one takes its place
  // there.
  bool leave_at_once(const GuardValues& middle, const GuardValues& end) {
    for (int i = 0; i < end.count; ++i) {
      if (now_guards_.value[i] > 0 || middle.value[i] > 0 || end.value[i] > 0) continue;
      switch_modes(i);
      return true;
    }
    return false;
  }

  ImpactState single_step(const AcceptedStep& from, double step_s) {
    ImpactState x, rate;
    rk_.do_step(std::cref(dynamics_), from.x, from.rate, from.time_s, x, rate, step_s);
    return x;
  }

  // Whether the part of a step up to an event meets the tolerance by itself. The whole step did,
  // but its stages may have passed by a rate that changes fast just before the event.
  bool exact_enough(double step_s) {
    if (step_s < 1e-12 * scales_.duration_s) return true;
    ImpactState x, rate, error;
    rk_.do_step(std::cref(dynamics_), now_.x, now_.rate, now_.time_s, x, rate, step_s, error);
    return checker_.error(rk_.algebra(), now_.x, now_.rate, error, step_s) <= 1;
  }

  // One step, or the part of it up to the first event. Returns whether a mode has changed.
  bool advance(double& step_s) {
    AcceptedStep next;
    next.time_s = now_.time_s;
    int failures = 0;
    while (stepper_.try_step(std::cref(dynamics_), now_.x, now_.rate, next.time_s, next.x,
                             next.rate, step_s) == odeint::fail) {
      if (++failures > 500) throw Error("the step size vanishes", "integration");
    }
    const double taken = next.time_s - now_.time_s;
    ImpactState middle;
    stepper_.stepper().calc_state(now_.time_s + 0.5 * taken, middle, now_.x, now_.rate, now_.time_s,
                                  next.x, next.rate, next.time_s);
    const GuardValues middle_guards = guards(middle), next_guards = guards(next.x);

    if (first_of_segment_) {
      first_of_segment_ = false;
      if (leave_at_once(middle_guards, next_guards)) return true;
    }
    double event_s = taken;
    int event = -1;
    for (int i = 0; i < next_guards.count; ++i) {
      const double root = guard_root(i, taken, middle_guards.value[i], next_guards.value[i]);
      if (root < event_s || (root == event_s && event < 0 && root < taken)) {
        event_s = root;
        event = i;
      }
    }
    if (event < 0) {
      record_until(next, nullptr);
      accept(next);
      now_guards_ = next_guards;
      return false;
    }
    if (!exact_enough(event_s)) {
      step_s = 0.5 * event_s;
      return false;
    }
    AcceptedStep at_event;
    at_event.time_s = now_.time_s + event_s;
    at_event.x = single_step(now_, event_s);
    record_until(at_event, &now_);
    accept(at_event);
    switch_modes(event);
    step_s = std::min(step_s, taken);
    return true;
  }

  // The time from now_ at which guard i falls through zero, infinite if it does not.
  double guard_root(int i, double taken, double middle, double end) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const double begin = now_guards_.value[i];
    double low = 0, high = taken, low_value = begin;
    if (begin > 0 && middle <= 0) {
      high = 0.5 * taken;
    } else if (middle > 0 && end <= 0) {
      low = 0.5 * taken;
    } else {
      return kNever;
    }
    const auto value = [&](double step) { return guards(single_step(now_, step)).value[i]; };
    if (low > 0) low_value = value(low);
    double high_value = value(high);
    if (high_value > 0 && high < taken) high_value = value(high = taken);
    if (!(low_value > 0)) {  // the interpolant and the step differ by rounding: it is there
      return begin > 0 ? low : kNever;
    }
    if (high_value > 0) return kNever;
    if (high_value == 0) return high;
    boost::uintmax_t iterations = 100;
    const auto close = [taken](double a, double b) { return std::abs(b - a) <= 1e-15 * taken; };
    return boost::math::tools::toms748_solve(value, low, high, low_value, high_value, close,
                                             iterations)
        .second;
  }

  // Hands over the points that were asked for up to `next`. Within a whole step they come from the
  // dense output; within a part of one (`from` given) from single steps, since the interpolant of
  // the whole step has seen the far side of the switch.
  void record_until(const AcceptedStep& next, const AcceptedStep* from) {
    for (double t = request_.next_s(); t <= next.time_s; t = request_.next_s()) {
      ImpactState x;
      if (from != nullptr) {
        x = single_step(*from, t - from->time_s);
      } else {
        stepper_.stepper().calc_state(t, x, now_.x, now_.rate, now_.time_s, next.x, next.rate,
                                      next.time_s);
      }
      request_.take(t, x);
    }
  }

  void accept(const AcceptedStep& next) {
    const ContactPoint at = dynamics_.contact_point(next.x);
    friction_.step(at);
    record_.count_step();
    if (record_.steps() > kMostSteps) throw Error("no progress", "integration");
    if (dynamics_.memory.compressing) {
      record_.step(dynamics_.normal_force_n(at), next.time_s - previous_.time_s,
                   [this](double s) { return force_after(previous_, s); });
    }
    previous_ = now_;
    now_ = next;
  }

  double force_after(const AcceptedStep& from, double step_s) {
    return dynamics_.normal_force_n(dynamics_.contact_point(single_step(from, step_s)));
  }

  void enter(PhaseKind kind, const char* name) {
    record_.enter(kind, name, {now_.time_s, &now_.x});
  }

  void switch_modes(int event) {
    if (++switches_ > kMostSwitches) throw Error("the contact's modes chatter", "integration");
    const ContactPoint at = dynamics_.contact_point(now_.x);
    switch (event) {
      case kTurn:
        turn(at);
        break;
      case kSeparation:
        done_ = true;
        break;
      case kReload:
        dynamics_.memory.unloading = false;
        break;
      case kKink:
        next_kink_m_ = normal_.next_kink_m(at.deflection_m);
        break;
      default:
        friction_.cross(event - kNormalGuards, at);
        enter(PhaseKind::kTangential, friction_.mode());
    }
  }

  void turn(const ContactPoint& at) {
    NormalMemory& memory = dynamics_.memory;
    if (!memory.compressing) {
      memory.compressing = true;
      enter(PhaseKind::kNormal, "compression");
      return;
    }
    record_.turn(now_.time_s, at, dynamics_.normal_force_n(at));
    memory = normal_.turn(at.deflection_m, memory);
    enter(PhaseKind::kNormal, "restitution");
  }

  const ImpactJob& job_;
  const NormalLaw& normal_;
  FrictionLaw& friction_;
  ContactDynamics& dynamics_;
  TrajectoryRequest& request_;
  double start_s_;
  ContactPoint touch_;
  ContactScales scales_;
  double next_kink_m_;
  ScaledError checker_;
  ContactStepper stepper_;
  Dopri5 rk_;
  AcceptedStep now_, previous_;
  GuardValues now_guards_{};
  bool done_ = false, first_of_segment_ = false;
  int switches_ = 0;
  ContactRecord record_;
};

}  // namespace

ContactOutcome integrate_contact(const ImpactJob& job, const NormalLaw& normal,
                                 FrictionLaw& friction, ContactDynamics& dynamics, double start_s,
                                 const ImpactState& start, TrajectoryRequest& request) {
  return Integration(job, normal, friction, dynamics, start_s, start, request).run();
}

}  // namespace impactdic::sim::contact
