#include "sim/contact/contact_dynamics.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

namespace impactdic::sim::contact {

ContactDynamics::ContactDynamics(const ImpactJob& job, const NormalLaw& normal,
                                 const FrictionLaw& friction)
    : normal_(normal),
      friction_(friction),
      mass_(job.body.mass_kg),
      inverse_mass_(1 / job.body.mass_kg),
      inverse_inertia_(1 / job.body.inertia()),
      gravity_t_(-job.gravity_m_s2 * std::sin(job.surface_angle_deg * kRadPerDeg)),
      gravity_n_(-job.gravity_m_s2 * std::cos(job.surface_angle_deg * kRadPerDeg)),
      rod_(job.body.shape == BodyShape::kRod),
      cap_(rod_ ? job.body.radius_m() : 0.0),
      reach_(rod_ ? job.body.length_m / 2 : job.body.radius_m()),
      start_angle_(job.initial.angle_deg * kRadPerDeg),
      rates_(friction.asks_force_rate()) {}

ContactDynamics::Arm ContactDynamics::arm(double angle_rad) const {
  if (!rod_) return {0, -reach_};
  const double axis = start_angle_ + angle_rad;
  return {-reach_ * std::cos(axis), -reach_ * std::sin(axis) - cap_};
}

void ContactDynamics::aim(const ImpactState& touch) {
  const double t = tip_t(touch), b = tip_b(touch);
  line_ = {};
  turning_ = false;
  if (b == 0) return;
  const double speed = std::hypot(t, b);
  line_ = {t / speed, b / speed};
  turning_ = gravity_t_ != 0;
}

void ContactDynamics::stop_turning(bool keep_line) {
  turning_ = false;
  if (!keep_line) line_ = {gravity_t_ > 0 ? 1.0 : -1.0, 0};
}

void ContactDynamics::turn_on(const ImpactState& x) {
  const double t = tip_t(x), b = tip_b(x), speed = std::hypot(t, b);
  if (speed == 0) return;
  line_ = {t / speed, b / speed};
  turning_ = true;
}

void ContactDynamics::rest(ImpactState& x) const {
  const double mobility = inverse_mass_ + reach_ * reach_ * inverse_inertia_;
  const double impulse_t = -tip_t(x) / mobility, impulse_b = -tip_b(x) / mobility;
  x[kVt] += impulse_t * inverse_mass_;
  x[kOmega] += reach_ * impulse_t * inverse_inertia_;
  x[kVb] += impulse_b * inverse_mass_;
  x[kOmegaT] -= reach_ * impulse_b * inverse_inertia_;
}

// Once the slip has stopped and come back within a step its last direction holds: the law finds the
// moment as the zero of the velocity along it.
SlipLine ContactDynamics::line(const ImpactState& x) const {
  if (!turning_) return line_;
  const double t = tip_t(x), b = tip_b(x);
  if (!(t * line_.t + b * line_.b > 0)) return line_;
  const double speed = std::hypot(t, b);
  return {t / speed, b / speed};
}

ContactPoint ContactDynamics::contact_point(const ImpactState& x) const {
  const Arm r = arm(x[kAngle]);
  const SlipLine along = line(x);
  ContactPoint at;
  at.deflection_m = 0.0 - x[kQn];  // not -0 at the touch
  if (rod_) at.deflection_m -= r.n + cap_ + reach_ * std::sin(start_angle_);
  at.rate_m_s = -(x[kVn] + x[kOmega] * r.t);
  at.centre_vt_m_s = x[kVt] * along.t + x[kVb] * along.b;
  at.tip_vt_m_s = (x[kVt] - x[kOmega] * r.n) * along.t + (x[kVb] + x[kOmegaT] * r.n) * along.b;
  at.tip_m = x[kTip];
  at.springs_m2 = x[kSprings];
  const double spring = normal_.spring_n(at.deflection_m, memory);
  at.compressing = memory.compressing;
  at.damping_n_s_per_m = normal_.damper_n(at.deflection_m, 1, memory);
  const double normal = spring + at.damping_n_s_per_m * at.rate_m_s;
  at.law_n = normal;
  at.spring_n = std::max(spring, 0.0);
  at.normal_n = std::max(normal, 0.0);
  at.acceleration_m_s2 = -(normal * inverse_mass_ + gravity_n_);  // of a ball
  // d(tip velocity)/dt = 0, with r' = omega x r for a rod's axis; its cap only rolls.
  at.mobility_per_kg = inverse_mass_ + r.n * r.n * inverse_inertia_;
  at.drift_m_s2 = -gravity_t_ * along.t + r.n * r.t * at.normal_n * inverse_inertia_ +
                  x[kOmega] * x[kOmega] * r.t;
  at.holding_n = -mass_ * gravity_t_ * along.t;
  if (rates_) add_force_rates(at);
  return at;
}

// The third derivative of the deflection is -dP/dt over the mass.
void ContactDynamics::add_force_rates(ContactPoint& at) const {
  const NormalLaw::Slopes s = normal_.slopes(at.deflection_m, memory);
  const double v = at.rate_m_s, a = at.acceleration_m_s2;
  at.spring_rate_n_s = s.spring * v;
  at.normal_rate_n_s = at.spring_rate_n_s + s.damper_slope * v * v + s.damper * a;
  const double jerk = -at.normal_rate_n_s * inverse_mass_;
  at.spring_turn_n_s2 = s.spring_turn * v * v + s.spring * a;
  at.normal_turn_n_s2 = at.spring_turn_n_s2 + s.damper_turn * v * v * v +
                        3 * s.damper_slope * v * a + s.damper * jerk;
}

void ContactDynamics::operator()(const ImpactState& x, ImpactState& rate, double) const {
  ++evaluations;
  const ContactPoint at = contact_point(x);
  const Arm r = arm(x[kAngle]);
  const double damper = at.damping_n_s_per_m * at.rate_m_s, normal = at.law_n;
  const Traction traction = friction_.traction(at);
  const SlipLine along = line(x);
  const double force_t = traction.force_n * along.t, force_b = traction.force_n * along.b;
  rate[kQt] = x[kVt];
  rate[kQn] = x[kVn];
  rate[kAngle] = x[kOmega];
  rate[kVt] = (force_t + traction.centre_force_n) * inverse_mass_ + gravity_t_;
  rate[kVn] = normal * inverse_mass_ + gravity_n_;
  rate[kOmega] = (r.t * normal - r.n * force_t) * inverse_inertia_;
  rate[kDamping] = damper * at.rate_m_s;
  rate[kSlip] = traction.dissipation_w;
  rate[kTip] = at.tip_vt_m_s;
  rate[kSprings] = traction.springs_rate_m2_s;
  rate[kQb] = x[kVb];
  rate[kVb] = force_b * inverse_mass_;
  rate[kOmegaT] = r.n * force_b * inverse_inertia_;
  rate[kOmegaN] = 0;
}

}  // namespace impactdic::sim::contact
