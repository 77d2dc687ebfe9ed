#include "sim/rod/rod_impact.h"

#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sim/contact/event_integrator.h"
#include "sim/rod/rod_dynamics.h"

namespace impactdic::sim::rod {
namespace {

constexpr double kStepsPerShortestPeriod = 20;
// Below it a state counts as zero for the tolerance: deflections of the modes are some 1e-6 to 1e-4
// m sqrt(kg), the compression as much in m.
constexpr double kScale = 1e-6;

const char* name(Friction friction) {
  switch (friction) {
    case Friction::kSlipForward:
      return "slip_forward";
    case Friction::kSlipBackward:
      return "slip_backward";
    case Friction::kStick:
      return "stick";
  }
  return "";
}

// One blow as the integrator sees it: phases of the contact and of the friction.
class Blow {
 public:
  using State = rod::State;

  explicit Blow(const RodJob& job)
      : job_(job), dynamics_(job), state_(dynamics_.start()), begin_(state_) {
    // A slow blow of a soft rod takes longer than the job foresees: 20 contacts of Hertz's
    // duration.
    const double speed = -dynamics_.rigid_tip_vn_m_s(state_);
    const double depth = dynamics_.law().largest_compression_m(job_.body.mass_kg, speed);
    longest_ = std::max(job_.longest_s, 20 * 2.94328 * depth / speed);
  }

  RodImpact run();

  enum Guard { kContactEnds, kReload, kFrictionEnds, kMostGuards };
  void rates(const State& x, State& rate) const { dynamics_.rates(x, rate, memory_); }
  int guards(const State& x, std::array<double, kMostGuards>& values) const;
  void switch_mode(int guard, double time_s, const State& x);
  bool finished() const { return over(); }
  template <typename StateWithin>
  void accepted(const contact::EventInstant<State>& next, double, const StateWithin&) {
    state_ = next.x;
    time_ = next.time_s;
  }
  double next_point_s() const;
  void take_point(double time_s, const State& x);
  // Stiffness jumps where a phase begins: from there on the step grows again.
  double restart_step_s(double) const { return first_step(); }

 private:
  double longest_step() const;
  double first_step() const { return std::min(1e-8, longest_step()); }
  double contact_guard(const State& state) const;
  double reload_guard(const State& state) const;
  double friction_guard(const State& state) const;
  void switch_contact(bool reload);
  void choose_friction(bool reversing);
  bool over() const;
  void set_contact(Contact contact, const std::string& phase);
  void set_friction(Friction friction);
  void finish();

  const RodJob job_;
  const Dynamics dynamics_;
  State state_, begin_;
  Memory memory_;
  State separation_;  // at the last separation so far
  double time_ = 0, contact_from_ = 0;
  double longest_ = 0;  // s, before the blow is given up
  RodImpact result_;
};

double Blow::longest_step() const {
  const double period = dynamics_.shortest_period_s();
  // A rigid rod: a fraction of a contact that lasts some 100 us, so that no separation is skipped.
  return period > 0 ? period / kStepsPerShortestPeriod : 2e-6;
}

// Down-crossing through zero ends the present contact phase; in flight an up-crossing would, hence
// the sign.
double Blow::contact_guard(const State& state) const {
  switch (memory_.contact) {
    case Contact::kFree:
      return memory_.residual_m - dynamics_.compression_m(state);
    case Contact::kLoading:
      return -dynamics_.tip_vn_m_s(state);
    case Contact::kUnloading:
      return dynamics_.compression_m(state) - memory_.residual_m;
  }
  return 0;
}

// Back at the largest compression so far while unloading.
double Blow::reload_guard(const State& state) const {
  if (memory_.contact != Contact::kUnloading) return 1;
  return memory_.largest_m - dynamics_.compression_m(state);
}

double Blow::friction_guard(const State& state) const {
  if (memory_.contact == Contact::kFree) return 1;
  if (memory_.friction == Friction::kStick) {
    const rod::Forces f = dynamics_.forces(state, memory_);
    return job_.friction_kinetic * f.normal_n - std::abs(f.holding_n);
  }
  const double forward = memory_.friction == Friction::kSlipForward ? 1 : -1;
  return forward * dynamics_.tip_vt_m_s(state);
}

int Blow::guards(const State& x, std::array<double, kMostGuards>& values) const {
  values = {contact_guard(x), reload_guard(x), friction_guard(x)};
  return kMostGuards;
}

void Blow::switch_mode(int guard, double time_s, const State& x) {
  time_ = time_s;
  state_ = x;
  if (guard == kFrictionEnds) {
    choose_friction(true);
  } else {
    switch_contact(guard == kReload);
  }
}

bool Blow::over() const {
  if (memory_.contact != Contact::kFree || memory_.largest_m == 0) return false;
  if (dynamics_.rigid_tip_vn_m_s(state_) <= 0) return false;
  return memory_.residual_m - dynamics_.rigid_compression_m(state_) >
         dynamics_.vibration_reach_m(state_);
}

double Blow::next_point_s() const {
  if (!(job_.sample_rate_hz > 0)) return std::numeric_limits<double>::infinity();
  return static_cast<double>(result_.trajectory.size()) / job_.sample_rate_hz;
}

void Blow::take_point(double time_s, const State& at) {
  const rod::Forces f = dynamics_.forces(at, memory_);
  result_.trajectory.push_back({time_s, at[0], at[1], at[2], at[dynamics_.rate(0)],
                                at[dynamics_.rate(1)], at[dynamics_.rate(2)], f.normal_n,
                                f.tangential_n, dynamics_.compression_m(at),
                                dynamics_.tip_vt_m_s(at), dynamics_.tip_vn_m_s(at)});
}

void Blow::set_contact(Contact contact, const std::string& phase) {
  if (!result_.normal_phases.empty()) result_.normal_phases.back().end_s = time_;
  result_.normal_phases.push_back({phase, time_, time_});
  memory_.contact = contact;
}

void Blow::set_friction(Friction friction) {
  memory_.friction = friction;
  auto& phases = result_.friction_phases;
  if (!phases.empty() && phases.back().end_s == 0) {
    if (phases.back().name == name(friction)) return;
    phases.back().end_s = time_;
  }
  phases.push_back({name(friction), time_, 0});
}

void Blow::switch_contact(bool reload) {
  switch (memory_.contact) {
    case Contact::kFree:
      contact_from_ = time_;
      ++result_.micro_impacts;
      if (memory_.largest_m > 0) {
        set_contact(Contact::kUnloading, "reloading");
      } else {
        set_contact(Contact::kLoading, "loading");
      }
      choose_friction(false);
      break;
    case Contact::kLoading:
      memory_.largest_m = std::max(memory_.largest_m, dynamics_.compression_m(state_));
      memory_.residual_m = dynamics_.law().residual_m(memory_.largest_m);
      result_.max_force_n =
          std::max(result_.max_force_n, dynamics_.law().loading_force_n(memory_.largest_m));
      set_contact(Contact::kUnloading, "unloading");
      break;
    case Contact::kUnloading:
      if (reload) {
        set_contact(Contact::kLoading, "loading");
      } else {
        set_contact(Contact::kFree, "free");
        result_.contact_s += time_ - contact_from_;
        result_.start_to_end_s = time_;
        separation_ = state_;
        if (!result_.friction_phases.empty()) result_.friction_phases.back().end_s = time_;
      }
      break;
  }
}

// Sticks where the flat can hold the tip, else slips the way it moves or would move. `reversing`:
// the slip has just come to rest, whatever the last digit of its velocity says.
void Blow::choose_friction(bool reversing) {
  const double velocity = dynamics_.tip_vt_m_s(state_);
  if (!reversing && std::abs(velocity) > 1e-12) {
    set_friction(velocity > 0 ? Friction::kSlipForward : Friction::kSlipBackward);
    return;
  }
  const rod::Forces f = dynamics_.forces(state_, memory_);
  const double limit = job_.friction_kinetic * f.normal_n;
  double direction = 0;  // of the slip that the force cannot prevent
  if (f.normal_n <= 0) {
    direction = dynamics_.tendency(state_);
  } else if (std::abs(f.holding_n) >= limit) {
    direction = f.holding_n > 0 ? -1 : 1;
  }
  if (direction == 0) {
    set_friction(Friction::kStick);
  } else {
    set_friction(direction > 0 ? Friction::kSlipForward : Friction::kSlipBackward);
  }
}

void Blow::finish() {
  const auto& d = dynamics_;
  // The rebound is the motion at the last separation: flight would turn the rod on.
  const State& end = separation_.empty() ? state_ : separation_;
  if (!result_.normal_phases.empty()) result_.normal_phases.back().end_s = time_;
  // The last flight has no end: it is followed only until no further blow can come.
  if (over() && !result_.normal_phases.empty()) result_.normal_phases.pop_back();
  result_.vt_m_s = end[d.rate(0)];
  result_.vn_m_s = end[d.rate(1)];
  result_.omega_rad_s = end[d.rate(2)];
  result_.tip_vn_before_m_s = d.rigid_tip_vn_m_s(begin_);
  result_.tip_vn_after_m_s = d.rigid_tip_vn_m_s(end);
  result_.tip_vt_after_m_s = d.rigid_tip_vt_m_s(end);
  result_.restitution = -result_.tip_vn_after_m_s / result_.tip_vn_before_m_s;
  result_.max_compression_m = memory_.largest_m;
  result_.residual_m = memory_.residual_m;
  const double* sum = end.data() + d.sums();
  RodEnergy& e = result_.energy;
  e.kinetic_before_j = d.kinetic_j(begin_);
  e.kinetic_after_j = d.kinetic_j(end);
  e.vibration_after_j = d.vibration_j(end);
  e.plastic_j = -sum[0];
  e.friction_j = -sum[1];
  e.damping_j = -sum[2];
  e.gravity_j = sum[3];
  e.residual_j = e.kinetic_before_j + e.gravity_j - e.kinetic_after_j - e.vibration_after_j -
                 e.plastic_j - e.friction_j - e.damping_j;
  result_.normal_impulse_n_s = sum[4];
  result_.tangential_impulse_n_s = sum[5];
  if (std::string why = d.law().out_of_range(memory_.largest_m); !why.empty()) {
    result_.warnings.push_back("outside the normal law's range: " + std::move(why));
  }
  if (!over()) {
    result_.restitution = std::numeric_limits<double>::quiet_NaN();
    result_.warnings.push_back("the rod had not left the flat after " + std::to_string(longest_) +
                               " s; the rebound is not final");
  }
}

RodImpact Blow::run() {
  memory_.contact = Contact::kFree;
  switch_contact(false);
  contact::EventLimits limits;
  limits.longest_s = longest_;
  limits.longest_step_s = longest_step();
  limits.negligible_s = 1e-16;
  limits.most_switches = 100000;
  limits.most_steps = std::numeric_limits<long>::max();  // longest_s is the end
  limits.hint = "loosen relative_tolerance or take fewer modes";
  using Checker =
      boost::numeric::odeint::default_error_checker<double, boost::numeric::odeint::range_algebra,
                                                    boost::numeric::odeint::default_operations>;
  const Checker checker(kScale * job_.relative_tolerance, job_.relative_tolerance);
  contact::EventIntegrator<Blow, Checker> integrator(*this, checker, limits, 0, state_);
  integrator.run(first_step());
  finish();
  return std::move(result_);
}

}  // namespace

RodImpact simulate_rod(const RodJob& job) {
  job.validate();
  return Blow(job).run();
}

}  // namespace impactdic::sim::rod

namespace impactdic {
namespace {

void require(bool good, const char* key, const char* hint) {
  if (!good) throw InvalidArgument("impossible value", key, hint);
}

}  // namespace

void RodJob::validate() const {
  surface.validate();
  require(body.length_m > 0 && std::isfinite(body.length_m), "length_m", "must be positive");
  require(body.radius_m > 0 && std::isfinite(body.radius_m), "radius_m", "must be positive");
  require(body.mass_kg > 0 && std::isfinite(body.mass_kg), "mass_kg", "must be positive");
  require(body.young_pa > 0 && std::isfinite(body.young_pa), "young_pa", "must be positive");
  require(friction_kinetic >= 0 && std::isfinite(friction_kinetic), "friction_kinetic",
          "must be zero or positive");
  require(axial_modes >= 0 && axial_modes <= 100, "axial_modes", "must lie in 0..100");
  require(bending_modes >= 0 && bending_modes <= 100, "bending_modes", "must lie in 0..100");
  require(modal_damping >= 0 && modal_damping < 1, "modal_damping", "must lie in 0..1");
  require(std::isfinite(angle_rad) && angle_rad > 0 && angle_rad < 3.1415926, "angle_deg",
          "the rod must point away from the flat: 0..180");
  require(relative_tolerance > 0 && relative_tolerance < 1e-2, "relative_tolerance",
          "must lie in 0..0.01");
  require(longest_s > 0, "longest_s", "must be positive");
  require(std::isfinite(vt_m_s) && std::isfinite(vn_m_s) && std::isfinite(omega_rad_s), "initial",
          "velocities must be numbers");
  require(sim::rod::Dynamics(*this).rigid_tip_vn_m_s(sim::rod::Dynamics(*this).start()) < 0,
          "initial", "the tip must approach the flat: vn_m_s - omega L/2 cos(angle) < 0");
}

RodJob rigid_rod_preset() {
  RodJob job;
  job.axial_modes = job.bending_modes = 0;
  job.residual = ResidualLaw::kJackson;
  return job;
}

RodJob flexible_rod_preset() { return RodJob{}; }

}  // namespace impactdic
