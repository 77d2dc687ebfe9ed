#include "sim/contact/contact_integration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "sim/contact/contact_record.h"
#include "sim/contact/event_integrator.h"
#include "sim/contact/step_control.h"

namespace impactdic::sim::contact {

namespace {

// The contact as the integrator sees it: modes of the normal law and of the friction law.
class ContactSystem {
 public:
  using State = ImpactState;

  ContactSystem(const ImpactJob& job, const NormalLaw& normal, FrictionLaw& friction,
                ContactDynamics& dynamics, double start_s, const ImpactState& start,
                TrajectoryRequest& request)
      : damping_(normal.ending()),
        normal_(normal),
        friction_(friction),
        dynamics_(dynamics),
        request_(request),
        ball_(job.body.shape != BodyShape::kRod),
        mass_kg_(job.body.mass_kg),
        keeps_direction_(job.friction == FrictionModel::kFullSliding),
        touch_((dynamics.memory = NormalMemory{}, dynamics.contact_point(start))),
        next_kink_m_(normal.next_kink_m(0)),
        record_(start_s, touch_.law_n) {}

  // The guards are the normal law's, then the friction law's.
  enum NormalGuard { kTurn, kSeparation, kReload, kKink, kPeak, kNormalGuards };
  static constexpr int kMostGuards = kNormalGuards + FrictionLaw::kMaxGuards;
  using Guards = std::array<double, kMostGuards>;

  void begin(double time_s, const State& x) {
    friction_.begin(touch_, time_s);
    force_rises_ = force_rate(touch_) > 0;
    record_.enter(ContactPhaseKind::kNormal, "compression", {time_s, &x});
    record_.enter(ContactPhaseKind::kTangential, friction_.mode(), {time_s, &x});
  }
  const ContactPoint& touch() const { return touch_; }
  ContactOutcome finish(double time_s, const State& x) {
    return record_.finish(separated_, {time_s, &x}, dynamics_.contact_point(x), dynamics_, normal_,
                          friction_);
  }

  void rates(const State& x, State& rate) const { dynamics_(x, rate, 0); }
  int guards(const State& x, Guards& values) const;
  void switch_mode(int guard, double time_s, State& x);
  bool finished() const { return separated_ || resting_; }
  double next_point_s() const { return request_.next_s(); }
  void take_point(double time_s, const State& x) { request_.take(time_s, x); }
  // The tolerance decides: a new mode begins as the last one ended.
  double restart_step_s(double step_s) const { return step_s; }

  template <typename StateWithin>
  void accepted(const EventInstant<State>& next, double, const StateWithin&) {
    const ContactPoint at = step_end(next.x);
    ++steps_;
    if (dynamics_.turning()) dynamics_.follow(next.x);
    request_.reach(next.time_s, next.x);
    friction_.step(at, next.time_s);
    record_.step(at.law_n);
    if (ball_ && (sinks_to_rest(at) || (goes_on_and_on() && creeps(at)))) resting_ = true;
  }

 private:
  // A little less or more deep: the two sides of a kink, which is located to about 1e-14.
  static constexpr double kBeside = 1e-12;
  ContactPoint shifted(State x, double part) const {
    x[kQn] -= part * std::abs(x[kQn]);
    return dynamics_.contact_point(x);
  }
  // A step that ends at a kink has come from below it.
  ContactPoint step_end(const State& x) const {
    const bool loading = dynamics_.memory.compressing && !dynamics_.memory.unloading;
    return loading && -x[kQn] > next_kink_m_ * (1 - 0.1 * kBeside) ? shifted(x, -kBeside)
                                                                   : dynamics_.contact_point(x);
  }
  // The weight presses a ball into a damped surface, and it stops there without turning.
  bool sinks_to_rest(const ContactPoint& at) const {
    const double speed = touch_.rate_m_s;
    return at.compressing && at.rate_m_s < 1e-12 * speed &&
           std::abs(at.acceleration_m_s2) * at.deflection_m < 1e-10 * speed * speed;
  }
  // A sound contact has a dozen switches and a few hundred steps.
  bool goes_on_and_on() const { return switches_ > 400 || steps_ > 20000; }
  bool creeps(const ContactPoint& at) const;
  double separation_guard(const ContactPoint& at) const;
  double force_rate(const ContactPoint& at) const;
  void turn(double time_s, const State& x, const ContactPoint& at);
  void cross_friction(int guard, State& x, const ContactPoint& at);

  RestitutionDamping damping_;
  const NormalLaw& normal_;
  FrictionLaw& friction_;
  ContactDynamics& dynamics_;
  TrajectoryRequest& request_;
  bool ball_;
  double mass_kg_;
  bool keeps_direction_;  // friction goes on as it was when the contact point has stopped
  ContactPoint touch_;
  double next_kink_m_;
  bool force_rises_ = true;  // in compression
  bool separated_ = false;
  bool resting_ = false;  // the body will not leave
  int switches_ = 0;
  long steps_ = 0;
  ContactRecord record_;
};

double ContactSystem::separation_guard(const ContactPoint& at) const {
  switch (damping_) {
    case RestitutionDamping::kToZeroForce:
      return at.law_n;
    case RestitutionDamping::kToZeroDeflection:
      return at.deflection_m;
    case RestitutionDamping::kNone:
      break;
  }
  return at.deflection_m - dynamics_.memory.residual_m;
}

// The weight hangs on a damper that gives way slowly, maybe for minutes, while all else dies down
// to rounding. A surface that lets go only at zero deflection keeps a ball whose energy is less
// than at rest up there: dampers only take.
bool ContactSystem::creeps(const ContactPoint& at) const {
  constexpr double kHangs = 1e-3;
  const double weight = -dynamics_.gravity_n();  // over the mass
  if (!at.compressing || damping_ != RestitutionDamping::kToZeroDeflection || normal_.adhesive() ||
      !(std::abs(at.acceleration_m_s2) < kHangs * weight)) {
    return false;
  }
  const double energy_j = 0.5 * mass_kg_ * at.rate_m_s * at.rate_m_s +
                          normal_.work_j(at.deflection_m, dynamics_.memory) -
                          mass_kg_ * weight * at.deflection_m;
  return energy_j < 0;
}

// Of dP/dt in compression, of a ball. A damper shifts the largest force before the largest
// deflection.
double ContactSystem::force_rate(const ContactPoint& at) const {
  return normal_.force_growth(at.deflection_m, at.rate_m_s, at.acceleration_m_s2);
}

// A guard of another phase stays at 1.
int ContactSystem::guards(const State& x, Guards& values) const {
  const ContactPoint at = dynamics_.contact_point(x);
  const NormalMemory& memory = dynamics_.memory;
  values[kTurn] = memory.compressing ? at.rate_m_s : -at.rate_m_s;
  values[kSeparation] = values[kReload] = values[kKink] = values[kPeak] = 1;
  if (memory.compressing && at.damping_n_s_per_m > 0 && ball_) {
    values[kPeak] = force_rises_ ? force_rate(at) : -force_rate(at);
  }
  if (!memory.compressing) {
    values[kSeparation] = separation_guard(at);
  } else if (memory.unloading) {
    values[kReload] = memory.max_deflection_m - at.deflection_m;
  } else {
    values[kKink] = next_kink_m_ - at.deflection_m;
  }
  FrictionLaw::Guards friction;
  const int count = friction_.guards(at, friction);
  std::copy_n(friction.begin(), count, values.begin() + kNormalGuards);
  return kNormalGuards + count;
}

void ContactSystem::switch_mode(int guard, double time_s, State& x) {
  ++switches_;
  const ContactPoint at = dynamics_.contact_point(x);
  switch (guard) {
    case kTurn:
      turn(time_s, x, at);
      break;
    case kSeparation:
      separated_ = true;
      break;
    case kReload:
      dynamics_.memory.unloading = false;
      break;
    case kPeak:  // its force is told of as every step's end
      force_rises_ = !force_rises_;
      break;
    case kKink:
      next_kink_m_ = normal_.next_kink_m(at.deflection_m);
      friction_.jump(shifted(x, -kBeside), shifted(x, kBeside));
      x[kSlip] += friction_.lost_at_once_j();
      break;
    default:
      cross_friction(guard - kNormalGuards, x, at);
      x[kSlip] += friction_.lost_at_once_j();
      record_.enter(ContactPhaseKind::kTangential, friction_.mode(), {time_s, &x});
  }
}

// Where a line of slip turns the law slides, and its one guard is the end of that.
void ContactSystem::cross_friction(int guard, State& x, const ContactPoint& at) {
  if (!dynamics_.turning()) return friction_.cross(guard, at);
  dynamics_.stop_turning(keeps_direction_);
  friction_.cross(guard, dynamics_.contact_point(x));
  if (std::string_view(friction_.mode()) == "sliding") {
    dynamics_.turn_on(x);
  } else if (!keeps_direction_) {
    dynamics_.rest(x);
  }
}

void ContactSystem::turn(double time_s, const State& x, const ContactPoint& at) {
  NormalMemory& memory = dynamics_.memory;
  if (!memory.compressing) {
    // The weight has turned the rebound of a ball before it could leave. No law gives back more
    // than that again, so it never will.
    if (ball_) {
      resting_ = true;
      return;
    }
    memory.compressing = true;
    force_rises_ = force_rate(dynamics_.contact_point(x)) > 0;
    record_.enter(ContactPhaseKind::kNormal, "compression", {time_s, &x});
    return;
  }
  record_.turn(time_s, at, at.law_n);
  memory = normal_.turn(at.deflection_m, memory);
  record_.enter(ContactPhaseKind::kNormal, "restitution", {time_s, &x});
}

}  // namespace

ContactOutcome integrate_contact(const ImpactJob& job, const NormalLaw& normal,
                                 FrictionLaw& friction, ContactDynamics& dynamics, double start_s,
                                 const ImpactState& start, TrajectoryRequest& request) {
  ContactSystem system(job, normal, friction, dynamics, start_s, start, request);
  const ContactScales scales = contact_scales(job, normal, system.touch(), start);
  EventLimits limits;
  limits.longest_s = 200 * scales.duration_s;
  limits.negligible_s = 1e-12 * scales.duration_s;
  limits.most_switches = 10000;
  limits.most_steps = 2000000;
  EventIntegrator<ContactSystem, ScaledError> integrator(
      system, ScaledError(job.solver.relative_tolerance, scales.state), limits, start_s, start);
  system.begin(start_s, start);
  integrator.run(1e-3 * scales.duration_s);
  return system.finish(integrator.now().time_s, integrator.now().x);
}

}  // namespace impactdic::sim::contact
