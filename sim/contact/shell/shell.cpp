#include "sim/contact/shell/shell.h"

#include <impactdic/units.h>

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>

#include "sim/contact/never.h"

namespace impactdic {

double BallShell::own_frequency_hz(double mass_kg) const {
  return std::sqrt(stiffness_n_per_m / (flat_fraction * (1 - flat_fraction) * mass_kg)) / (2 * kPi);
}

}  // namespace impactdic

namespace impactdic::sim::contact {
namespace {

// The way of the part in contact, all in numbers without derivatives: y and y' at a time.
class SwingingWay {
 public:
  SwingingWay(const Shell<double>& shell, const ImpactState& x, double gravity_n)
      : shell_(shell), x_(x), gravity_n_(gravity_n) {}

  double centre_m(double t) const { return -x_[kQn] - t * (x_[kVn] + 0.5 * gravity_n_ * t); }
  double depth_m(double t) const { return centre_m(t) - shell_.reach(swung(t)[kFlat]); }
  double rate_m_s(double t) const {
    return -x_[kVn] - gravity_n_ * t - shell_.reach(swung(t)[kFlatRate]);
  }
  // When the mass centre comes back to this depth; infinite where it does not.
  double back_at_s(double depth_m, double after_s) const {
    if (!(gravity_n_ < 0)) return kNever;
    const double speed = x_[kVn], height = -x_[kQn] - depth_m;
    const double root = speed * speed + 2 * gravity_n_ * height;
    if (!(root >= 0)) return kNever;
    const double t = (speed + std::sqrt(root)) / -gravity_n_;
    return t > after_s ? t : kNever;
  }

 private:
  ImpactState swung(double t) const {
    ImpactState x = x_;
    shell_.swing(x, t);
    return x;
  }

  const Shell<double>& shell_;
  const ImpactState& x_;
  double gravity_n_;
};

template <typename Function>
double root_between(const Function& value, double low, double high) {
  std::uintmax_t most = 200;
  const auto [a, b] = boost::math::tools::toms748_solve(
      value, low, high, boost::math::tools::eps_tolerance<double>(52), most);
  return 0.5 * (a + b);
}

// Where the depth rises through zero within (low, high), low above the surface; or never.
double touch_within(const SwingingWay& way, double low, double high) {
  const auto depth = [&](double t) { return way.depth_m(t); };
  if (!(depth(low) < 0)) return kNever;
  double top = high;
  if (!(depth(high) >= 0)) {  // it may have been there between
    if (!(way.rate_m_s(low) > 0 && way.rate_m_s(high) < 0)) return kNever;
    top = root_between([&](double t) { return way.rate_m_s(t); }, low, high);
    if (!(depth(top) > 0)) return kNever;
  }
  return root_between(depth, low, top);
}

}  // namespace

template <typename Real>
Shell<Real>::Shell(const JobNumbers<Real>& numbers)
    : given_(numbers.has_shell),
      stiffness_(numbers.shell.stiffness_n_per_m),
      damping_(numbers.shell.damping_n_s_per_m),
      fraction_(numbers.shell.flat_fraction),
      flat_kg_(fraction_ * numbers.body.mass_kg),
      reduced_kg_(flat_kg_ * (1.0 - fraction_)) {}

template <typename Real>
Real Shell<Real>::acceleration(const State& x, const Real& pressed_n) const {
  return pressed_n / flat_kg_ - force_n(x) / reduced_kg_;
}

template <typename Real>
Real Shell<Real>::contact_acceleration(const State& x, const Real& pressed_n) const {
  return (force_n(x) - pressed_n) / flat_kg_;
}

template <typename Real>
Real Shell<Real>::energy_j(const State& x) const {
  if (!given_) return Real(0);
  return 0.5 * (stiffness_ * x[kFlat] * x[kFlat] + reduced_kg_ * x[kFlatRate] * x[kFlatRate]);
}

// The damped oscillation, below critical damping (BallShell is checked for that).
template <typename Real>
void Shell<Real>::swing(State& x, const Real& elapsed) const {
  const Real before_j = energy_j(x);
  const Real square = stiffness_ / reduced_kg_, decay = damping_ / (2.0 * reduced_kg_);
  const Real omega = sqrt(square - decay * decay);
  const Real c = cos(omega * elapsed), s = sin(omega * elapsed) / omega;
  const Real left = exp(-decay * elapsed), d = x[kFlat], rate = x[kFlatRate];
  x[kFlat] = left * (d * c + (rate + decay * d) * s);
  x[kFlatRate] = left * (rate * c - (decay * rate + square * d) * s);
  x[kDamping] += before_j - energy_j(x);
}

// At the turn the moment does not matter, so that it needs no derivatives.
template <typename Real>
Real Shell<Real>::flattest_in_flight(const State& x, const Real& flight_s) const {
  const double d = value_of(x[kFlat]), rate = value_of(x[kFlatRate]);
  const double square = value_of(stiffness_ / reduced_kg_);
  const double decay = value_of(damping_ / (2.0 * reduced_kg_));
  const double omega = std::sqrt(square - decay * decay);
  const double turn_s = std::atan2(rate * omega, decay * rate + square * d) / omega;
  if (!(rate > 0 && turn_s < flight_s)) return Real(0);
  State at = x;
  swing(at, Real(turn_s));
  return at[kFlat];
}

template <typename Real>
auto Shell<Real>::next_touch(const State& x, const Real& gravity_n) const -> Touch {
  if constexpr (kHasDerivatives<Real>) {
    JobNumbers<double> plain;
    plain.has_shell = true;
    plain.body.mass_kg = value_of(flat_kg_ / fraction_);
    plain.shell = {value_of(stiffness_), value_of(damping_), value_of(fraction_)};
    const auto [after, same_blow] =
        Shell<double>(plain).next_touch(values_of(x), value_of(gravity_n));
    if (after == kNever) return {Real(kNever), false};
    State at = x;
    swing(at, Real(after));
    const Real depth = -x[kQn] - after * (x[kVn] + 0.5 * gravity_n * after) - reach(at[kFlat]);
    const double rate = value_of(-x[kVn] - gravity_n * after - reach(at[kFlatRate]));
    return {Real(after, -depth.v / rate), same_blow};
  } else {
    constexpr int kPartsOfPeriod = 64, kMostPeriods = 10000;
    const SwingingWay way(*this, x, gravity_n);
    const double most = reach(std::sqrt(2 * energy_j(x) / stiffness_));
    const double step = 2 * kPi * std::sqrt(reduced_kg_ / stiffness_) / kPartsOfPeriod;
    bool same_blow = true;
    double low = 1e-6 * step;  // just left: the surface is where it began
    for (int i = 0; i < kPartsOfPeriod * kMostPeriods; ++i) {
      if (same_blow && way.centre_m(low) < -most) {  // out of reach until it falls back
        same_blow = false;
        low = way.back_at_s(-most, low);
        if (low == kNever) break;
      }
      const double touch = touch_within(way, low, low + step);
      if (touch != kNever) return {touch, same_blow};
      low += step;
    }
    return {kNever, false};
  }
}

template class Shell<double>;
template class Shell<Sensitive>;

}  // namespace impactdic::sim::contact
