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
      start_angle_(job.initial.angle_deg * kRadPerDeg) {}

ContactDynamics::Arm ContactDynamics::arm(double angle_rad) const {
  if (!rod_) return {0, -reach_};
  const double axis = start_angle_ + angle_rad;
  return {-reach_ * std::cos(axis), -reach_ * std::sin(axis) - cap_};
}

ContactPoint ContactDynamics::contact_point(const ImpactState& x) const {
  const Arm r = arm(x[kAngle]);
  ContactPoint at;
  at.deflection_m = 0.0 - x[kQn];  // not -0 at the touch
  if (rod_) at.deflection_m -= r.n + cap_ + reach_ * std::sin(start_angle_);
  at.rate_m_s = -(x[kVn] + x[kOmega] * r.t);
  at.centre_vt_m_s = x[kVt];
  at.tip_vt_m_s = x[kVt] - x[kOmega] * r.n;
  at.tip_m = x[kTip];
  at.springs_m2 = x[kSprings];
  const double spring = spring_n(at);
  at.compressing = memory.compressing;
  at.damping_n_s_per_m = normal_.damper_n(at.deflection_m, 1, memory);
  const double normal = spring + normal_.damper_n(at.deflection_m, at.rate_m_s, memory);
  at.spring_n = std::max(spring, 0.0);
  at.normal_n = std::max(normal, 0.0);
  at.acceleration_m_s2 = -(normal * inverse_mass_ + gravity_n_);  // of a ball
  // d(tip velocity)/dt = 0, with r' = omega x r for a rod's axis; its cap only rolls.
  at.mobility_per_kg = inverse_mass_ + r.n * r.n * inverse_inertia_;
  at.rolling_n =
      (-gravity_t_ + r.n * r.t * at.normal_n * inverse_inertia_ + x[kOmega] * x[kOmega] * r.t) /
      at.mobility_per_kg;
  at.holding_n = -mass_ * gravity_t_;
  return at;
}

double ContactDynamics::normal_force_n(const ContactPoint& at) const {
  return spring_n(at) + normal_.damper_n(at.deflection_m, at.rate_m_s, memory);
}

void ContactDynamics::operator()(const ImpactState& x, ImpactState& rate, double) const {
  ++evaluations;
  const ContactPoint at = contact_point(x);
  const Arm r = arm(x[kAngle]);
  const double damper = normal_.damper_n(at.deflection_m, at.rate_m_s, memory);
  const double normal = spring_n(at) + damper;
  const Traction traction = friction_.traction(at);
  rate[kQt] = x[kVt];
  rate[kQn] = x[kVn];
  rate[kAngle] = x[kOmega];
  rate[kVt] = (traction.force_n + traction.centre_force_n) * inverse_mass_ + gravity_t_;
  rate[kVn] = normal * inverse_mass_ + gravity_n_;
  rate[kOmega] = (r.t * normal - r.n * traction.force_n) * inverse_inertia_;
  rate[kDamping] = damper * at.rate_m_s;
  rate[kSlip] = traction.dissipation_w;
  rate[kTip] = at.tip_vt_m_s;
  rate[kSprings] = traction.springs_rate_m2_s;
}

}  // namespace impactdic::sim::contact
