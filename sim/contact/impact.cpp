#include "sim/contact/impact.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "host/base/parse.h"
#include "host/impact/impulse_figures.h"
#include "sim/contact/contact_integration.h"
#include "sim/contact/contact_record.h"
#include "sim/contact/flight/flight.h"
#include "sim/contact/never.h"
#include "sim/contact/orientation_path.h"
#include "sim/contact/two_bodies.h"

namespace impactdic::sim::contact {

namespace {

BodyState body_state(const ImpactState& x, const Eigen::Quaterniond& q,
                     const Shell<double>& shell) {
  return {x[kQt],
          x[kQn],
          x[kAngle],
          x[kVt],
          x[kVn],
          x[kOmega],
          x[kQb],
          x[kVb],
          x[kOmegaT],
          x[kOmegaN],
          {q.w(), q.x(), q.y(), q.z()},
          x[kFlat],
          x[kFlatRate],
          shell.lag(x[kFlat]),
          shell.lag(x[kFlatRate])};
}

// A ledger is closed to this part of the kinetic energy at the start.
constexpr double kLedgerTolerance = 1e-9;
constexpr double kStrictestTolerance = 1e-13;

// `rounding`: of the largest term, which may be far larger than the kinetic energy.
bool closes(const EnergyLedger& energy, double limit, double rounding) {
  const double largest =
      std::max({energy.kinetic_start_j, energy.kinetic_j, std::abs(energy.gravity_j),
                energy.normal_elastic_j, std::abs(energy.air_j), energy.damping_j,
                std::abs(energy.slip_j), energy.plastic_j});
  return std::abs(energy.residual_j) <= limit * energy.kinetic_start_j + rounding * largest;
}

class ImpactRun final : public TrajectoryRequest<double> {
 public:
  ImpactRun(const ImpactJob& job, const Recording& recording)
      : job_(job),
        recording_(recording),
        numbers_(job),
        flight_(numbers_),
        shell_(numbers_),
        normal_(make_normal_law(job, numbers_)),
        orientation_(job.body),
        turns_(job.body.shape != BodyShape::kRod) {}

  ImpactResult run() {
    now_[kVt] = job_.initial.vt_m_s;
    now_[kVn] = job_.initial.vn_m_s;
    now_[kOmega] = job_.initial.omega_rad_s;
    now_[kQn] = job_.initial.gap_m;
    now_[kVb] = job_.initial.vb_m_s;
    now_[kOmegaT] = job_.initial.omega_t_rad_s;
    now_[kOmegaN] = job_.initial.omega_n_rad_s;
    start_ = now_;
    orientation_.start(0, start_);
    result_.start = state(0, now_);
    for (int contact = 0; contact < job_.solver.contacts; ++contact) {
      if (!reach_surface(contact)) break;
      follow_contact();
      while (result_.separated && flight_.touches_again(now_) && reach_surface(contact + 1)) {
        follow_contact();
      }
      if (contact == 0) describe_blow();
      if (!result_.separated) break;
      blow_.reset();
    }
    finish();
    return std::move(result_);
  }

  double next_s() const override {
    if (recording_.rate_hz > 0) return static_cast<double>(taken_) / recording_.rate_hz;
    return taken_ < recording_.times_s.size() ? recording_.times_s[taken_] : kNever;
  }

  void take(const double& time_s, const ImpactState& x) override {
    ++taken_;
    result_.trajectory.push_back(point(time_s, x));
  }

  void reach(const double& time_s, const ImpactState& x) override {
    if (turns_) orientation_.reach(time_s, x);
  }

 private:
  BodyState state(double time_s, const ImpactState& x) const {
    return body_state(x, turns_ ? orientation_.at(time_s, x) : Eigen::Quaterniond::Identity(),
                      shell_);
  }

  double gravity_t() const { return flight_.gravity_t(); }
  double gravity_n() const { return flight_.gravity_n(); }

  // Flies to the next touch and says whether there is one.
  bool reach_surface(int contact) {
    double flight = 0;
    if (contact > 0 || now_[kQn] > 0) flight = flight_.time_to_touch(now_);
    if (contact == 0 && flight == kNever) {
      throw InvalidArgument("the body never touches the surface", "initial.gap_m");
    }
    if (flight == kNever) return false;
    if (flight > 0) {
      const double touch_s = time_s_ + flight;
      record_flight(std::nextafter(touch_s, 0.0));
      result_.phases.push_back({ContactPhaseKind::kFlight, "flight", time_s_, touch_s, 0});
      if (blow_) {
        blow_->max_flattening_m = std::max(blow_->max_flattening_m, flight_.flattest(now_, flight));
      }
      const Flight<double>::Flown flown = flight_.after(now_, flight);
      now_ = flown.state;
      air_j_ += flown.air_j;
      flight_.put_down(now_);
      time_s_ = touch_s;
      reach(time_s_, now_);
    } else {
      record_flight(-std::numeric_limits<double>::min());
    }
    return true;
  }

  // Hands over the points asked for up to `until_s`, all in free flight.
  void record_flight(double until_s) {
    const double before_j = air_j_;
    for (double t = next_s(); t <= until_s; t = next_s()) {
      const Flight<double>::Flown flown = flight_.after(now_, t - time_s_);
      air_j_ = before_j + flown.air_j;
      take(t, flown.state);
    }
    air_j_ = before_j;
  }

  void follow_contact() {
    now_[kTip] = now_[kSprings] = 0;
    friction_ = make_friction_law(job_, numbers_, now_[kVt], now_[kVn]);
    dynamics_.emplace(numbers_, *normal_, *friction_);
    dynamics_->aim(now_, remembers_slip(job_.friction));
    if (dynamics_->turning() && remembers_slip(job_.friction)) {
      throw InvalidArgument(
          std::string(name_of(job_.friction)) + " knows no slip that the weight turns", "friction",
          "gravity 0, a level surface, or coulomb");
    }
    const ContactPoint touch = dynamics_->contact_point(now_);
    if (!(touch.rate_m_s > 0)) {
      throw InvalidArgument("the body does not approach the surface", "initial.vn_m_s",
                            "the normal points out of the surface: vn_m_s must be negative");
    }
    if (!blow_) first_touch_ = {time_s_, touch.rate_m_s, now_};
    const ContactOutcome outcome =
        integrate_contact<double>(job_, *normal_, *friction_, *dynamics_, time_s_, now_, *this);
    result_.evaluations += dynamics_->evaluations;
    result_.steps += outcome.steps;
    time_s_ = outcome.end_s;
    now_ = outcome.end;
    if (recording_.rate_hz > 0 && outcome.separated) {
      result_.trajectory.push_back(point(time_s_, now_));
    }
    result_.separated = outcome.separated;
    result_.phases.insert(result_.phases.end(), outcome.phases.begin(), outcome.phases.end());
    warn(outcome);
    tip_end_ = {dynamics_->tip_t(now_), dynamics_->tip_b(now_)};
    if (blow_) {
      continue_blow(*blow_, outcome);
    } else {
      blow_ = outcome;
      tip_start_ = {dynamics_->tip_t(first_touch_.x), dynamics_->tip_b(first_touch_.x)};
    }
    if (outcome.separated) {
      dynamics_.reset();  // from here on the body flies
      plastic_j_ += outcome.plastic_j;
      now_[kDamping] += outcome.released_j;
      now_[kSlip] += outcome.released_tangential_j;
    }
  }

  void describe_blow() {
    const double nan = kNotMeasured;
    const ContactOutcome& outcome = *blow_;
    const ImpactState &before = first_touch_.x, &after = outcome.end;
    const double duration = outcome.end_s - first_touch_.time_s, mass = job_.body.mass_kg;
    // Of the contact point; the part of a shell that lies on the surface swings.
    const double out = shell_.given() ? after[kVn] : -outcome.end_point.rate_m_s;
    result_.contact_start_s = first_touch_.time_s;
    result_.contact_s = outcome.separated ? duration : nan;
    result_.t_max_compression_s = outcome.t_max_compression_s;
    result_.max_deflection_m = outcome.max_deflection_m;
    result_.max_force_n = outcome.max_force_n;
    result_.peak_force_n = outcome.peak_force_n;
    result_.separation_force_n = outcome.separation_force_n;
    result_.max_flattening_m = outcome.max_flattening_m;
    result_.restitution = outcome.separated ? out / first_touch_.rate_m_s : nan;
    result_.tip_vt_start_m_s = tip_start_.t;
    result_.tip_vt_final_m_s = tip_end_.t;
    result_.tip_vb_start_m_s = tip_start_.b;
    result_.tip_vb_final_m_s = tip_end_.b;
    result_.impulse_t_n_s = mass * (after[kVt] - before[kVt] - gravity_t() * duration);
    result_.impulse_b_n_s = mass * (after[kVb] - before[kVb]);
    result_.impulse_n_n_s = mass * (after[kVn] - before[kVn] - gravity_n() * duration);
  }

  void warn(const ContactOutcome& outcome) {
    const double noise_j = 1e-9 * kinetic_j(start_);
    for (const ContactPhase& phase : outcome.phases) {
      if (phase.slip_j >= -noise_j) continue;
      result_.warnings.push_back("friction does positive work in phase '" +
                                 std::string(phase.name) + "': it feeds " +
                                 shortest(-phase.slip_j) + " J into the body from " +
                                 shortest(phase.start_s) + " s to " + shortest(phase.end_s) + " s");
    }
    if (outcome.separated && !normal_->adhesive() &&
        outcome.separation_force_n < -1e-9 * outcome.max_force_n) {
      result_.warnings.push_back("the surface pulls: the normal force ends at " +
                                 shortest(outcome.separation_force_n) + " N");
    }
    if (std::string why = normal_->out_of_range(outcome.max_deflection_m); !why.empty()) {
      result_.warnings.push_back("outside the normal law's range: " + std::move(why));
    }
    if (!outcome.separated) {
      result_.warnings.push_back("the body did not leave the surface: it comes to rest on it");
    }
  }

  void finish() {
    if (result_.separated && recording_.rate_hz <= 0) {
      record_flight(std::numeric_limits<double>::max());
    }
    result_.final = state(time_s_, now_);
    result_.end_s = time_s_;
    result_.energy = ledger(time_s_, now_);
  }

  double kinetic_j(const ImpactState& x) const {
    return 0.5 * job_.body.mass_kg * (x[kVt] * x[kVt] + x[kVn] * x[kVn] + x[kVb] * x[kVb]) +
           0.5 * job_.body.inertia() * x[kOmega] * x[kOmega] +
           0.5 * job_.body.inertia() * (x[kOmegaT] * x[kOmegaT] + x[kOmegaN] * x[kOmegaN]);
  }

  EnergyLedger ledger(double time_s, const ImpactState& x) const {
    EnergyLedger energy;
    energy.kinetic_start_j = kinetic_j(start_);
    energy.gravity_j = job_.body.mass_kg * (gravity_t() * (x[kQt] - start_[kQt]) +
                                            gravity_n() * (x[kQn] - start_[kQn])) +
                       0.0;  // not -0
    energy.kinetic_j = kinetic_j(x);
    energy.damping_j = x[kDamping];
    energy.slip_j = x[kSlip];
    energy.plastic_j = plastic_j_;
    energy.air_j = air_j_;
    energy.vibration_j = shell_.energy_j(x);
    if (dynamics_) {
      const ContactPoint at = dynamics_->contact_point(x);
      energy.normal_elastic_j = normal_->stored_j(at.deflection_m, dynamics_->memory);
      energy.plastic_j +=
          normal_->work_j(at.deflection_m, dynamics_->memory) - energy.normal_elastic_j;
      energy.tangential_elastic_j = friction_->stored_j(at, time_s);
    }
    energy.residual_j = energy.kinetic_start_j + energy.gravity_j - energy.kinetic_j -
                        energy.normal_elastic_j - energy.damping_j - energy.tangential_elastic_j -
                        energy.slip_j - energy.plastic_j - energy.air_j - energy.vibration_j;
    return energy;
  }

  TrajectoryPoint point(double time_s, const ImpactState& x) const {
    TrajectoryPoint point;
    point.time_s = time_s;
    point.state = state(time_s, x);
    point.energy = ledger(time_s, x);
    if (dynamics_) {
      const ContactPoint at = dynamics_->contact_point(x);
      point.deflection_m = at.deflection_m;
      point.normal_force_n = at.law_n;
      const double friction = friction_->traction(at).force_n;
      const SlipLine line = dynamics_->line(x);
      point.tangential_force_n = friction * line.t;
      point.tangential_force_b_n = friction * line.b;
      point.tip_vt_m_s = dynamics_->tip_t(x);
      point.tip_vb_m_s = dynamics_->tip_b(x);
    } else {
      point.tip_vt_m_s = x[kVt] + x[kOmega] * job_.body.radius_m();
      point.tip_vb_m_s = x[kVb] - x[kOmegaT] * job_.body.radius_m();
    }
    return point;
  }

  const ImpactJob& job_;
  const Recording recording_;
  const JobNumbers<double> numbers_;
  const Flight<double> flight_;
  const Shell<double> shell_;
  std::unique_ptr<NormalLaw> normal_;
  std::unique_ptr<FrictionLaw> friction_;
  std::optional<ContactDynamics> dynamics_;  // while in contact
  OrientationPath orientation_;
  bool turns_;  // an orientation is told of balls
  ImpactState now_{}, start_{};
  // Of the blow that is followed: one contact, of a shell those of its own swing.
  struct Touch {
    double time_s = 0, rate_m_s = 0;
    ImpactState x{};
  };
  struct Tip {
    double t = 0, b = 0;
  };
  Touch first_touch_;
  Tip tip_start_, tip_end_;
  std::optional<ContactOutcome> blow_;
  double time_s_ = 0;
  double plastic_j_ = 0;  // of the contacts before
  double air_j_ = 0;      // of the flights
  std::size_t taken_ = 0;
  ImpactResult result_;
};

}  // namespace

ImpactResult simulate_impact(const ImpactJob& job, const Recording& recording) {
  job.validate();
  if (job.other) {
    return of_two_bodies(job, simulate_impact(relative_job(job), recording));
  }
  // Hard cases (friction of 100, a weight that does far more work than the blow) add errors up.
  ImpactJob attempt = job;
  for (;;) {
    ImpactResult result = ImpactRun(attempt, recording).run();
    const double limit = std::max(kLedgerTolerance, 10 * job.solver.relative_tolerance);
    if (closes(result.energy, limit, 1e-14)) return result;
    if (attempt.solver.relative_tolerance <= kStrictestTolerance) {
      if (closes(result.energy, limit, 1e-12)) return result;
      throw Error("the energy ledger does not close: " + shortest(result.energy.residual_j) +
                      " J of " + shortest(result.energy.kinetic_start_j) + " J are unaccounted for",
                  "integration", "report this job");
    }
    attempt.solver.relative_tolerance =
        std::max(0.01 * attempt.solver.relative_tolerance, kStrictestTolerance);
  }
}

EffectiveFriction effective_friction(const ImpactBody& body, const BodyState& before,
                                     const BodyState& after, double contact_s, double gravity_m_s2,
                                     double surface_angle_deg) {
  const double angle = surface_angle_deg * kRadPerDeg;
  const double dvt = after.vt_m_s - before.vt_m_s, dvn = after.vn_m_s - before.vn_m_s;
  const double dvb = after.vb_m_s - before.vb_m_s;
  const double gravity_s = gravity_m_s2 * contact_s;
  EffectiveFriction friction;
  const auto tip = [&](const BodyState& s) {
    return impact::tip_velocity({s.vt_m_s, s.vb_m_s}, s.omega_rad_s, s.omega_t_rad_s,
                                body.radius_m());
  };
  const impact::Tangential slip = impact::slip_direction(tip(before));
  friction.published = -impact::impulse_ratio(impact::along(slip, {dvt, dvb}), dvn);
  const double dvt_sound =
      impact::surface_impulse(before.vt_m_s, after.vt_m_s, -gravity_s * std::sin(angle));
  friction.sound = -impact::impulse_ratio(
      impact::along(slip, {dvt_sound, dvb}),
      impact::surface_impulse(before.vn_m_s, after.vn_m_s, -gravity_s * std::cos(angle)));
  friction.rolling_cap = impact::rolling_cap(tip(before), tip(after), body.inertia_factor(), dvn);
  return friction;
}

}  // namespace impactdic::sim::contact
