#include "sim/contact/flight/flight.h"

#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

#include "sim/contact/never.h"

namespace impactdic::sim::contact {
namespace {

// Steps in the air: of the fourth order, their error is (step x rate)^5 / 120.
constexpr double kLongestStep_s = 1e-3, kStepPart = 2e-3;
constexpr double kLongestFlight_s = 100;

template <typename Real>
using Vector = std::array<Real, 3>;  // along t, n, b

template <typename Real>
Vector<Real> cross(const Vector<Real>& a, const Vector<Real>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <typename Real>
Vector<Real> velocity(const ImpactStateOf<Real>& x) {
  return {x[kVt], x[kVn], x[kVb]};
}
template <typename Real>
Vector<Real> spin(const ImpactStateOf<Real>& x) {
  return {x[kOmegaT], x[kOmegaN], x[kOmega]};
}

// The closed form, gravity alone.
template <typename Real>
ImpactStateOf<Real> fall(const ImpactStateOf<Real>& from, const Real& gravity_t,
                         const Real& gravity_n, const Real& elapsed) {
  ImpactStateOf<Real> x = from;
  x[kQt] += elapsed * (from[kVt] + 0.5 * gravity_t * elapsed);
  x[kQn] += elapsed * (from[kVn] + 0.5 * gravity_n * elapsed);
  x[kQb] += elapsed * from[kVb];
  x[kAngle] += elapsed * from[kOmega];
  x[kVt] += gravity_t * elapsed;
  x[kVn] += gravity_n * elapsed;
  return x;
}

template <typename Real>
Real time_to_fall(const ImpactStateOf<Real>& x, const Real& gravity_n) {
  const Real &height = x[kQn], &speed = x[kVn];
  if (gravity_n >= 0) {
    if (gravity_n == 0) return speed < 0 && height > 0 ? Real(-height / speed) : Real(kNever);
    const Real root = speed * speed - 2.0 * gravity_n * height;
    // Gravity lifts off: only a fast enough approach touches.
    return speed < 0 && height > 0 && root >= 0
               ? Real(2.0 * height / (-speed + contact::root(root)))
               : Real(kNever);
  }
  const Real root = speed * speed - 2.0 * gravity_n * height;
  if (root < 0) return Real(kNever);
  const Real fall = contact::root(root);
  // The form without cancellation for either sign of the speed.
  return speed > 0 ? Real((speed + fall) / -gravity_n) : Real(2.0 * height / (fall - speed));
}

}  // namespace

template <typename Real>
Flight<Real>::Flight(const JobNumbers<Real>& numbers)
    : shell_(numbers),
      gravity_t_(numbers.gravity_t()),
      gravity_n_(numbers.gravity_n()),
      mass_kg_(numbers.body.mass_kg) {
  const Real radius = numbers.body.radius_m();
  const Real pressed = numbers.air_density_kg_m3 * kPi * radius * radius / (2.0 * mass_kg_);
  drag_per_m_ = pressed * numbers.drag_coefficient;
  lift_ = pressed * radius * numbers.lift_coefficient;
}

// The spin stays: a ball's decays over seconds.
template <typename Real>
auto Flight<Real>::step(const Flown& from, const Real& h) const -> Flown {
  struct Rate {
    Vector<Real> velocity, acceleration;
    Real power_w;
  };
  const Vector<Real> start = velocity<Real>(from.state), omega = spin<Real>(from.state);
  const auto rate = [&](const Vector<Real>& v) {
    const Real speed = hypot(v[0], v[1], v[2]);
    const Vector<Real> across = cross<Real>(omega, v);
    Rate r{v, {gravity_t_, gravity_n_, Real(0)}, mass_kg_ * drag_per_m_ * speed * speed * speed};
    for (std::size_t i = 0; i < 3; ++i) {
      r.acceleration[i] += lift_ * across[i] - drag_per_m_ * speed * v[i];
    }
    return r;
  };
  const auto moved = [&](const Rate& r, const Real& by) {
    Vector<Real> v = start;
    for (std::size_t i = 0; i < 3; ++i) v[i] += by * r.acceleration[i];
    return v;
  };
  const Rate a = rate(start), b = rate(moved(a, h / 2.0)), c = rate(moved(b, h / 2.0)),
             d = rate(moved(c, h));
  const auto mean = [&](const Real& first, const Real& second, const Real& third,
                        const Real& fourth) -> Real {
    return h * (first + 2.0 * second + 2.0 * third + fourth) / 6.0;
  };
  Flown to = from;
  constexpr std::array kPlace{kQt, kQn, kQb}, kSpeed{kVt, kVn, kVb};
  for (std::size_t i = 0; i < 3; ++i) {
    to.state[kPlace[i]] += mean(a.velocity[i], b.velocity[i], c.velocity[i], d.velocity[i]);
    to.state[kSpeed[i]] +=
        mean(a.acceleration[i], b.acceleration[i], c.acceleration[i], d.acceleration[i]);
  }
  to.state[kAngle] += h * from.state[kOmega];
  to.air_j += mean(a.power_w, b.power_w, c.power_w, d.power_w);
  return to;
}

template <typename Real>
int Flight<Real>::steps(const State& from, double elapsed) const {
  const ImpactState x = values_of(from);
  const Vector<double> v = velocity<double>(x), omega = spin<double>(x);
  const double fastest = std::hypot(v[0], v[1], v[2]) +
                         std::hypot(value_of(gravity_t_), value_of(gravity_n_)) * std::abs(elapsed);
  const double rate = value_of(drag_per_m_) * fastest +
                      std::abs(value_of(lift_)) * std::hypot(omega[0], omega[1], omega[2]);
  const double step = std::min(kLongestStep_s, kStepPart / rate);
  return std::max(1, static_cast<int>(std::ceil(std::abs(elapsed) / step)));
}

template <typename Real>
auto Flight<Real>::after(const State& from, const Real& elapsed) const -> Flown {
  if (drag_per_m_ == 0 && lift_ == 0) {
    Flown flown{fall<Real>(from, gravity_t_, gravity_n_, elapsed)};
    if (swings(from)) shell_.swing(flown.state, elapsed);
    return flown;
  }
  Flown flown{from};
  const int count = elapsed == 0 ? (kHasDerivatives<Real> ? 1 : 0) : steps(from, value_of(elapsed));
  for (int i = 0; i < count; ++i) flown = step(flown, elapsed / static_cast<double>(count));
  return flown;
}

// A step begins above the surface, or has just left it. Magnus' force may turn the way so that it
// ends above the surface again, or comes down to it while the ball already rises.
template <typename Real>
double Flight<Real>::touch_within(const Flown& from, const Flown& to, double h) const {
  const auto height = [&](double part) { return value_of(step(from, Real(part)).state[kQn]); };
  const auto rise = [&](double part) { return value_of(step(from, Real(part)).state[kVn]); };
  const auto root = [](const auto& value, double low, double high) {
    std::uintmax_t most = 100;
    const auto [a, b] = boost::math::tools::toms748_solve(
        value, low, high, boost::math::tools::eps_tolerance<double>(52), most);
    return (a + b) / 2;
  };
  double low = 0, high = h;
  if (to.state[kQn] > 0) {
    if (!(from.state[kVn] < 0 && to.state[kVn] > 0)) return kNever;
    high = root(rise, 0, h);  // the lowest point
    if (height(high) > 0) return kNever;
  }
  if (!(from.state[kQn] > 0)) {
    // The surface is where it began: it must have risen first.
    for (low = high / 2; !(height(low) > 0); low /= 2) {
      if (low < 1e-9 * h) return kNever;
    }
  }
  return root(height, low, high);
}

template <typename Real>
Real Flight<Real>::time_to_touch(const State& from) const {
  if (swings(from)) return shell_.next_touch(from, gravity_n_).after_s;
  if (drag_per_m_ == 0 && lift_ == 0) return time_to_fall<Real>(from, gravity_n_);
  if (from[kQn] == 0 && from[kVn] <= 0) return Real(kNever);
  Flown flown{from};
  for (double elapsed = 0; elapsed < kLongestFlight_s;) {
    const double h = kLongestStep_s / std::max(1, steps(flown.state, kLongestStep_s));
    const Flown next = step(flown, Real(h));
    const double part = touch_within(flown, next, h);
    if (part < kNever) {
      if constexpr (kHasDerivatives<Real>) {
        const Flown at = step(flown, Real(part));
        return {elapsed + part, -at.state[kQn].v / at.state[kVn].a};
      } else {
        return elapsed + part;
      }
    }
    flown = next;
    elapsed += h;
  }
  return Real(kNever);
}

template class Flight<double>;
template class Flight<Sensitive>;

}  // namespace impactdic::sim::contact
