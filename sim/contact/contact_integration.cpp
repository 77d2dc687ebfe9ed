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
template <typename Real>
class ContactSystem {
 public:
  using State = ImpactStateOf<Real>;
  using ContactPoint = ContactPointOf<Real>;
  using FrictionLaw = FrictionLawOf<Real>;

  ContactSystem(const ImpactJob& job, const NormalLawOf<Real>& normal, FrictionLaw& friction,
                ContactDynamicsOf<Real>& dynamics, const Real& start_s, const State& start,
                TrajectoryRequest<Real>& request)
      : damping_(normal.ending()),
        normal_(normal),
        friction_(friction),
        dynamics_(dynamics),
        request_(request),
        ball_(job.body.shape != BodyShape::kRod),
        shell_(job.shell.has_value()),
        mass_kg_(job.body.mass_kg),
        keeps_direction_(job.friction == FrictionModel::kFullSliding),
        touch_((dynamics.memory = NormalMemoryOf<Real>{}, dynamics.contact_point(start))),
        next_kink_m_(normal.next_kink_m(Real(0))),
        record_(start_s, touch_.law_n) {}

  // The guards are the normal law's, then the friction law's.
  enum NormalGuard { kTurn, kSeparation, kReload, kKink, kPeak, kFlattest, kNormalGuards };
  static constexpr int kMostGuards = kNormalGuards + FrictionLaw::kMaxGuards;
  using Guards = std::array<Real, kMostGuards>;

  void begin(const Real& time_s, State& x) {
    friction_.begin(touch_, time_s);
    come_to_rest(x);
    force_rises_ = force_rate(touch_) > 0;
    flattens_ = !(x[kFlatRate] < 0);
    record_.enter(ContactPhaseKind::kNormal, "compression", {time_s, &x});
    record_.enter(ContactPhaseKind::kTangential, friction_.mode(), {time_s, &x});
  }
  const ContactPoint& touch() const { return touch_; }
  ContactOutcomeOf<Real> finish(const Real& time_s, const State& x) {
    return record_.finish(separated_, {time_s, &x}, dynamics_.contact_point(x), dynamics_, normal_,
                          friction_);
  }

  void rates(const State& x, State& rate) const {
    dynamics_(x, rate, 0);
    if constexpr (kHasDerivatives<Real>) {
      if (held_) hold_deflection(x, rate);
    }
  }
  int guards(const State& x, Guards& values) const;
  void switch_mode(int guard, const Real& time_s, State& x);
  bool finished() const { return separated_ || resting_; }
  State just_before(int guard, State x) const {
    if (guard == kKink) x[kQn] += kBeside * abs(x[kQn]);
    return x;
  }
  // On the way out, once it is fast enough for the deflection, or the force, to tell the time.
  int fixed_guard(const State& x) const {
    if (shell_) return -1;  // its part in contact may turn back again
    const ContactPoint at = dynamics_.contact_point(x);
    const auto& memory = dynamics_.memory;
    const bool by_force = damping_ == RestitutionDamping::kToZeroForce;
    const Real& most = by_force ? memory.max_force_n : memory.max_deflection_m;
    const bool out = !memory.compressing && at.rate_m_s < -1e-9 * touch_.rate_m_s &&
                     separation_guard(at) < 0.5 * most;
    return out ? kSeparation : -1;
  }
  // From here on the deflection, and not the time, is held within a step as well.
  void hold(int guard) {
    held_ = guard == kSeparation && damping_ != RestitutionDamping::kToZeroForce;
  }
  // What that has moved the instant by.
  void keep_time(Real& time_s, State& x) const requires kHasDerivatives<Real> {
    if (!held_) return;
    time_s.v += x[kClock].v;
    x[kClock] = Real(0);
  }
  double next_point_s() const { return request_.next_s(); }
  void take_point(Real time_s, State x) {
    if constexpr (kHasDerivatives<Real>) keep_time(time_s, x);
    request_.take(time_s, x);
  }
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
  // The instants move with the inputs so that the deflection does not: an infinite slope of the
  // force, as where a jkr contact parts, is then not asked for.
  void hold_deflection(const State& x, State& rate) const requires kHasDerivatives<Real> {
    const Real down = dynamics_.contact_point(x).rate_m_s;
    const auto moves = (-down.v / down.a).eval();
    for (Real& part : rate) part.v += part.a * moves;
    rate[kClock] = Real(0.0, moves);
  }
  // A little less or more deep: the two sides of a kink, which is located to about 1e-14.
  static constexpr double kBeside = 1e-12;
  ContactPoint shifted(State x, double part) const {
    x[kQn] -= part * abs(x[kQn]);
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
    const double speed = value_of(touch_.rate_m_s);
    return at.compressing && at.rate_m_s < 1e-12 * speed &&
           abs(at.acceleration_m_s2) * at.deflection_m < 1e-10 * speed * speed;
  }
  // A sound contact has a dozen switches and a few hundred steps.
  bool goes_on_and_on() const { return switches_ > 400 || steps_ > 20000; }
  bool creeps(const ContactPoint& at) const;
  Real separation_guard(const ContactPoint& at) const;
  Real force_rate(const ContactPoint& at) const;
  void turn(const Real& time_s, const State& x, const ContactPoint& at);
  // Dry friction takes away any little slip of a contact point that is to rest.
  void come_to_rest(State& x) const {
    if (!kHasDerivatives<Real> || !ball_ || std::string_view(friction_.mode()) != "rolling") return;
    dynamics_.rest(x);
    dynamics_.stop_across();
  }
  void cross_friction(int guard, State& x, const ContactPoint& at);

  RestitutionDamping damping_;
  const NormalLawOf<Real>& normal_;
  FrictionLaw& friction_;
  ContactDynamicsOf<Real>& dynamics_;
  TrajectoryRequest<Real>& request_;
  bool ball_;
  bool shell_;
  double mass_kg_;
  bool keeps_direction_;  // friction goes on as it was when the contact point has stopped
  ContactPoint touch_;
  Real next_kink_m_;
  bool force_rises_ = true;  // in compression
  bool flattens_ = true;     // a shell
  bool held_ = false;        // the deflection, on the way out
  bool separated_ = false;
  bool resting_ = false;  // the body will not leave
  int switches_ = 0;
  long steps_ = 0;
  ContactRecord<Real> record_;
};

template <typename Real>
Real ContactSystem<Real>::separation_guard(const ContactPoint& at) const {
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
template <typename Real>
bool ContactSystem<Real>::creeps(const ContactPoint& at) const {
  constexpr double kHangs = 1e-3;
  const double weight = -value_of(dynamics_.gravity_n());  // over the mass
  if (!at.compressing || damping_ != RestitutionDamping::kToZeroDeflection || normal_.adhesive() ||
      !(abs(at.acceleration_m_s2) < kHangs * weight)) {
    return false;
  }
  const Real energy_j = 0.5 * mass_kg_ * at.rate_m_s * at.rate_m_s +
                        normal_.work_j(at.deflection_m, dynamics_.memory) -
                        mass_kg_ * weight * at.deflection_m;
  return energy_j < 0;
}

// Of dP/dt in compression, of a ball. A damper shifts the largest force before the largest
// deflection.
template <typename Real>
Real ContactSystem<Real>::force_rate(const ContactPoint& at) const {
  return normal_.force_growth(at.deflection_m, at.rate_m_s, at.acceleration_m_s2);
}

// A guard of another phase stays at 1.
template <typename Real>
int ContactSystem<Real>::guards(const State& x, Guards& values) const {
  const ContactPoint at = dynamics_.contact_point(x);
  const auto& memory = dynamics_.memory;
  values[kTurn] = memory.compressing ? at.rate_m_s : Real(-at.rate_m_s);
  values[kSeparation] = values[kReload] = values[kKink] = values[kPeak] = values[kFlattest] =
      Real(1);
  if (shell_) values[kFlattest] = flattens_ ? x[kFlatRate] : Real(-x[kFlatRate]);
  if (memory.compressing && at.damping_n_s_per_m > 0 && ball_) {
    values[kPeak] = force_rises_ ? force_rate(at) : Real(-force_rate(at));
  }
  if (!memory.compressing) {
    values[kSeparation] = separation_guard(at);
  } else if (memory.unloading) {
    values[kReload] = memory.max_deflection_m - at.deflection_m;
  } else {
    values[kKink] = next_kink_m_ - at.deflection_m;
  }
  typename FrictionLaw::Guards friction;
  const int count = friction_.guards(at, friction);
  // A line that turns turns ever faster as the slip stops: its derivatives are those of a moment
  // before.
  if (kHasDerivatives<Real> && dynamics_.turning())
    friction[0] -= 1e-9 * value_of(touch_.tip_vt_m_s);
  std::copy_n(friction.begin(), count, values.begin() + kNormalGuards);
  return kNormalGuards + count;
}

template <typename Real>
void ContactSystem<Real>::switch_mode(int guard, const Real& time_s, State& x) {
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
    case kFlattest:
      if (flattens_) record_.flatten(x[kFlat]);
      flattens_ = !flattens_;
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
template <typename Real>
void ContactSystem<Real>::cross_friction(int guard, State& x, const ContactPoint& at) {
  if (!dynamics_.turning()) {
    friction_.cross(guard, at);
    return come_to_rest(x);
  }
  dynamics_.stop_turning(x, keeps_direction_);
  friction_.cross(guard, dynamics_.contact_point(x));
  if (std::string_view(friction_.mode()) == "sliding") {
    dynamics_.turn_on(x);
  } else if (!keeps_direction_) {
    dynamics_.rest(x);
  }
}

template <typename Real>
void ContactSystem<Real>::turn(const Real& time_s, const State& x, const ContactPoint& at) {
  NormalMemoryOf<Real>& memory = dynamics_.memory;
  if (!memory.compressing) {
    // The weight has turned the rebound of a ball before it could leave. No law gives back more
    // than that again, so it never will.
    if (ball_ && !shell_) {
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

template <typename Real>
ContactOutcomeOf<Real> integrate_contact(const ImpactJob& job, const NormalLawOf<Real>& normal,
                                         FrictionLawOf<Real>& friction,
                                         ContactDynamicsOf<Real>& dynamics, const Real& start_s,
                                         const ImpactStateOf<Real>& start,
                                         TrajectoryRequest<Real>& request) {
  using System = ContactSystem<Real>;
  System system(job, normal, friction, dynamics, start_s, start, request);
  const ContactScales scales =
      contact_scales(job, normal, value_of(system.touch().rate_m_s), values_of(start));
  EventLimits limits;
  limits.longest_s = 200 * scales.duration_s;
  limits.negligible_s = 1e-12 * scales.duration_s;
  limits.most_switches = 10000;
  limits.most_steps = kHasDerivatives<Real> ? 50000 : 2000000;
  ImpactStateOf<Real> first = start;
  system.begin(start_s, first);
  EventIntegrator<System, ScaledError<Real>> integrator(
      system,
      ScaledError<Real>(job.solver.relative_tolerance, scales.state, 1e-13 * scales.duration_s),
      limits, start_s, first);
  integrator.run(1e-3 * scales.duration_s);
  return system.finish(integrator.now().time_s, integrator.now().x);
}

template ContactOutcome integrate_contact(const ImpactJob&, const NormalLaw&, FrictionLaw&,
                                          ContactDynamics&, const double&, const ImpactState&,
                                          TrajectoryRequest<double>&);
template ContactOutcomeOf<Sensitive> integrate_contact(
    const ImpactJob&, const NormalLawOf<Sensitive>&, FrictionLawOf<Sensitive>&,
    ContactDynamicsOf<Sensitive>&, const Sensitive&, const ImpactStateOf<Sensitive>&,
    TrajectoryRequest<Sensitive>&);

}  // namespace impactdic::sim::contact
