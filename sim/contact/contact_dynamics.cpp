#include "sim/contact/contact_dynamics.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

namespace impactdic::sim::contact {

template <typename Real>
ContactDynamicsOf<Real>::ContactDynamicsOf(const JobNumbers<Real>& numbers,
                                           const NormalLawOf<Real>& normal,
                                           const FrictionLawOf<Real>& friction)
    : normal_(normal),
      friction_(friction),
      shell_(numbers),
      resistance_(numbers),
      mass_(numbers.body.mass_kg),
      inverse_mass_(1.0 / numbers.body.mass_kg),
      inverse_inertia_(1.0 / numbers.body.inertia()),
      gravity_t_(numbers.gravity_t()),
      gravity_n_(numbers.gravity_n()),
      rod_(numbers.body.shape == BodyShape::kRod),
      cap_(rod_ ? numbers.body.radius_m() : Real(0)),
      reach_(rod_ ? Real(numbers.body.length_m / 2.0) : numbers.body.radius_m()),
      start_angle_(numbers.initial.angle_deg * kRadPerDeg),
      rates_(friction.asks_force_rate()) {}

template <typename Real>
auto ContactDynamicsOf<Real>::arm(const Real& angle_rad) const -> Arm {
  if (!rod_) return {Real(0), -reach_};
  const Real axis = start_angle_ + angle_rad;
  return {-reach_ * cos(axis), -reach_ * sin(axis) - cap_};
}

template <typename Real>
void ContactDynamicsOf<Real>::aim(const State& touch, bool remembers) {
  const Real t = tip_t(touch), b = tip_b(touch);
  line_ = {};
  turning_ = across_ = false;
  if (b == 0) {
    // A little slip across turns the line by its part of the slip along.
    if (kHasDerivatives<Real> && t != 0) line_.b = b / t;
    across_ = kHasDerivatives<Real> && t != 0 && gravity_t_ != 0 && !remembers;
    // What rolls across is braked across.
    if (!resistance_.of_rolling() || touch[kOmegaT] == 0) return;
    turning_ = t != 0;
    line_ = turning_ ? SlipLine{Real(t > 0 ? 1.0 : -1.0), Real(0)} : line_at_rest(touch);
    return;
  }
  const Real speed = hypot(t, b);
  line_ = {t / speed, b / speed};
  turning_ = pushed();
}

template <typename Real>
void ContactDynamicsOf<Real>::stop_turning(const State& x, bool keep_line) {
  turning_ = false;
  if (!keep_line) line_ = line_at_rest(x);
}

// Along which what rests is pushed: the way it rolls where that is braked, else down the slope.
template <typename Real>
auto ContactDynamicsOf<Real>::line_at_rest(const State& x) const -> SlipLine {
  const Real &b = x[kOmega], &t = x[kOmegaT];
  if (!resistance_.of_rolling() || t == 0) return {Real(gravity_t_ > 0 ? 1.0 : -1.0), Real(0)};
  const Real spin = hypot(b, t);
  return {-b / spin, t / spin};
}

template <typename Real>
void ContactDynamicsOf<Real>::turn_on(const State& x) {
  const Real t = tip_t(x), b = tip_b(x), speed = hypot(t, b);
  if (speed == 0) return;
  line_ = {t / speed, b / speed};
  turning_ = true;
}

template <typename Real>
void ContactDynamicsOf<Real>::rest(State& x) const {
  const Real mobility = inverse_mass_ + reach_ * reach_ * inverse_inertia_;
  const Real impulse_t = -tip_t(x) / mobility, impulse_b = -tip_b(x) / mobility;
  x[kVt] += impulse_t * inverse_mass_;
  x[kOmega] += reach_ * impulse_t * inverse_inertia_;
  x[kVb] += impulse_b * inverse_mass_;
  x[kOmegaT] -= reach_ * impulse_b * inverse_inertia_;
}

// Once the slip has stopped and come back within a step its last direction holds: the law finds the
// moment as the zero of the velocity along it.
template <typename Real>
auto ContactDynamicsOf<Real>::line(const State& x) const -> SlipLine {
  if (!turning_) {
    if (!across_) return line_;
    const Real t = tip_t(x);
    if (t == 0) return {line_.t, Real(0)};  // it has just stopped
    return {line_.t, tip_b(x) / t};
  }
  const Real t = tip_t(x), b = tip_b(x);
  if (!(t * line_.t + b * line_.b > 0)) return line_;
  const Real speed = hypot(t, b);
  return {t / speed, b / speed};
}

template <typename Real>
auto ContactDynamicsOf<Real>::contact_point(const State& x) const -> ContactPoint {
  const Arm r = arm(x[kAngle]);
  const SlipLine along = line(x);
  ContactPoint at;
  at.deflection_m = 0.0 - x[kQn];  // not -0 at the touch
  if (rod_) at.deflection_m -= r.n + cap_ + reach_ * sin(start_angle_);
  at.rate_m_s = -(x[kVn] + x[kOmega] * r.t);
  if (shell_.given()) {  // the part that lies on the surface
    at.deflection_m -= shell_.reach(x[kFlat]);
    at.rate_m_s -= shell_.reach(x[kFlatRate]);
  }
  at.centre_vt_m_s = x[kVt] * along.t + x[kVb] * along.b;
  at.tip_vt_m_s = (x[kVt] - x[kOmega] * r.n) * along.t + (x[kVb] + x[kOmegaT] * r.n) * along.b;
  at.tip_m = x[kTip];
  at.springs_m2 = x[kSprings];
  const Real spring = normal_.spring_n(at.deflection_m, memory);
  at.compressing = memory.compressing;
  at.damping_n_s_per_m = normal_.damper_n(at.deflection_m, Real(1), memory);
  const Real normal = spring + at.damping_n_s_per_m * at.rate_m_s;
  at.law_n = normal;
  at.spring_n = at_least(spring, 0);
  at.normal_n = at_least(normal, 0);
  at.acceleration_m_s2 = -(normal * inverse_mass_ + gravity_n_);  // of a ball
  if (shell_.given()) {
    at.acceleration_m_s2 = shell_.contact_acceleration(x, normal) - gravity_n_;
  }
  // d(tip velocity)/dt = 0, with r' = omega x r for a rod's axis; its cap only rolls.
  at.mobility_per_kg = inverse_mass_ + r.n * r.n * inverse_inertia_;
  at.drift_m_s2 = -gravity_t_ * along.t + r.n * r.t * at.normal_n * inverse_inertia_ +
                  x[kOmega] * x[kOmega] * r.t;
  at.holding_n = -mass_ * gravity_t_ * along.t;
  if (resistance_.of_rolling()) {
    const auto couple = resistance_.couple(x, at.normal_n, at.deflection_m);
    at.drift_m_s2 += r.n * inverse_inertia_ * (couple.b * along.t - couple.t * along.b);
  }
  if (rates_) add_force_rates(at);
  return at;
}

// The third derivative of the deflection is -dP/dt over the mass.
template <typename Real>
void ContactDynamicsOf<Real>::add_force_rates(ContactPoint& at) const {
  const auto s = normal_.slopes(at.deflection_m, memory);
  const Real v = at.rate_m_s, a = at.acceleration_m_s2;
  at.spring_rate_n_s = s.spring * v;
  at.normal_rate_n_s = at.spring_rate_n_s + s.damper_slope * v * v + s.damper * a;
  const Real jerk = -at.normal_rate_n_s * inverse_mass_;
  at.spring_turn_n_s2 = s.spring_turn * v * v + s.spring * a;
  at.normal_turn_n_s2 = at.spring_turn_n_s2 + s.damper_turn * v * v * v +
                        3.0 * s.damper_slope * v * a + s.damper * jerk;
}

template <typename Real>
void ContactDynamicsOf<Real>::operator()(const State& x, State& rate, double) const {
  ++evaluations;
  const ContactPoint at = contact_point(x);
  const Arm r = arm(x[kAngle]);
  const Real damper = at.damping_n_s_per_m * at.rate_m_s, normal = at.law_n;
  const auto traction = friction_.traction(at);
  const SlipLine along = line(x);
  const Real force_t = traction.force_n * along.t, force_b = traction.force_n * along.b;
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
  rate[kOmegaN] = Real(0);
  rate[kFlat] = rate[kFlatRate] = Real(0);
  if (resistance_.acts()) {
    const auto couple = resistance_.couple(x, at.normal_n, at.deflection_m);
    rate[kOmega] += couple.b * inverse_inertia_;
    rate[kOmegaT] += couple.t * inverse_inertia_;
    rate[kOmegaN] += couple.n * inverse_inertia_;
    rate[kSlip] += resistance_.dissipation_w(x, couple);
  }
  if (!shell_.given()) return;
  rate[kFlat] = x[kFlatRate];
  rate[kFlatRate] = shell_.acceleration(x, normal);
  rate[kDamping] += shell_.dissipation_w(x);
}

template class ContactDynamicsOf<double>;
template class ContactDynamicsOf<Sensitive>;

}  // namespace impactdic::sim::contact
