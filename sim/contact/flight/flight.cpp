#include "sim/contact/flight/flight.h"

#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>

namespace impactdic::sim::contact {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
// Steps in the air: of the fourth order, their error is (step x rate)^5 / 120.
constexpr double kLongestStep_s = 1e-3, kStepPart = 2e-3;
constexpr double kLongestFlight_s = 100;

using Vector = std::array<double, 3>;  // along t, n, b

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector velocity(const ImpactState& x) { return {x[kVt], x[kVn], x[kVb]}; }
Vector spin(const ImpactState& x) { return {x[kOmegaT], x[kOmegaN], x[kOmega]}; }

// The closed form, gravity alone.
ImpactState fall(const ImpactState& from, double gravity_t, double gravity_n, double elapsed) {
  ImpactState x = from;
  x[kQt] += elapsed * (from[kVt] + 0.5 * gravity_t * elapsed);
  x[kQn] += elapsed * (from[kVn] + 0.5 * gravity_n * elapsed);
  x[kQb] += elapsed * from[kVb];
  x[kAngle] += elapsed * from[kOmega];
  x[kVt] += gravity_t * elapsed;
  x[kVn] += gravity_n * elapsed;
  return x;
}

double time_to_fall(const ImpactState& x, double gravity_n) {
  const double height = x[kQn], speed = x[kVn];
  if (gravity_n >= 0) {
    if (gravity_n == 0) return speed < 0 && height > 0 ? -height / speed : kNever;
    const double root = speed * speed - 2 * gravity_n * height;
    // Gravity lifts off: only a fast enough approach touches.
    return speed < 0 && height > 0 && root >= 0 ? 2 * height / (-speed + std::sqrt(root)) : kNever;
  }
  const double root = speed * speed - 2 * gravity_n * height;
  if (root < 0) return kNever;
  const double fall = std::sqrt(root);
  // The form without cancellation for either sign of the speed.
  return speed > 0 ? (speed + fall) / -gravity_n : 2 * height / (fall - speed);
}

}  // namespace

Flight::Flight(const ImpactJob& job)
    : gravity_t_(-job.gravity_m_s2 * std::sin(job.surface_angle_deg * kRadPerDeg)),
      gravity_n_(-job.gravity_m_s2 * std::cos(job.surface_angle_deg * kRadPerDeg)),
      mass_kg_(job.body.mass_kg) {
  const double radius = job.body.radius_m();
  const double pressed = job.air.density_kg_m3 * kPi * radius * radius / (2 * mass_kg_);
  drag_per_m_ = pressed * job.air.drag_coefficient;
  lift_ = pressed * radius * job.air.lift_coefficient;
}

// The spin stays: a ball's decays over seconds.
Flight::Flown Flight::step(const Flown& from, double h) const {
  struct Rate {
    Vector velocity, acceleration;
    double power_w;
  };
  const Vector start = velocity(from.state), omega = spin(from.state);
  const auto rate = [&](const Vector& v) {
    const double speed = std::hypot(v[0], v[1], v[2]);
    const Vector across = cross(omega, v);
    Rate r{v, {gravity_t_, gravity_n_, 0}, mass_kg_ * drag_per_m_ * speed * speed * speed};
    for (std::size_t i = 0; i < 3; ++i) {
      r.acceleration[i] += lift_ * across[i] - drag_per_m_ * speed * v[i];
    }
    return r;
  };
  const auto moved = [&](const Rate& r, double by) {
    Vector v = start;
    for (std::size_t i = 0; i < 3; ++i) v[i] += by * r.acceleration[i];
    return v;
  };
  const Rate a = rate(start), b = rate(moved(a, h / 2)), c = rate(moved(b, h / 2)),
             d = rate(moved(c, h));
  const auto mean = [&](double first, double second, double third, double fourth) {
    return h * (first + 2 * second + 2 * third + fourth) / 6;
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

int Flight::steps(const ImpactState& from, double elapsed) const {
  const Vector v = velocity(from), omega = spin(from);
  const double fastest =
      std::hypot(v[0], v[1], v[2]) + std::hypot(gravity_t_, gravity_n_) * std::abs(elapsed);
  const double rate =
      drag_per_m_ * fastest + std::abs(lift_) * std::hypot(omega[0], omega[1], omega[2]);
  const double step = std::min(kLongestStep_s, kStepPart / rate);
  return std::max(1, static_cast<int>(std::ceil(std::abs(elapsed) / step)));
}

Flight::Flown Flight::after(const ImpactState& from, double elapsed) const {
  if (drag_per_m_ == 0 && lift_ == 0) return {fall(from, gravity_t_, gravity_n_, elapsed)};
  Flown flown{from};
  const int count = elapsed == 0 ? 0 : steps(from, elapsed);
  for (int i = 0; i < count; ++i) flown = step(flown, elapsed / count);
  return flown;
}

double Flight::time_to_touch(const ImpactState& from) const {
  if (drag_per_m_ == 0 && lift_ == 0) return time_to_fall(from, gravity_n_);
  if (from[kQn] == 0 && from[kVn] <= 0) return kNever;
  Flown flown{from};
  for (double elapsed = 0; elapsed < kLongestFlight_s;) {
    const double h = kLongestStep_s / std::max(1, steps(flown.state, kLongestStep_s));
    const Flown next = step(flown, h);
    if (next.state[kQn] <= 0 && next.state[kVn] < 0) {
      const auto height = [&](double part) { return step(flown, part).state[kQn]; };
      std::uintmax_t most = 100;
      const double first = height(0) > 0 ? 0 : h / 2;  // just left: the surface is where it began
      const auto [low, high] = boost::math::tools::toms748_solve(
          height, first, h, boost::math::tools::eps_tolerance<double>(52), most);
      return elapsed + (low + high) / 2;
    }
    flown = next;
    elapsed += h;
  }
  return kNever;
}

}  // namespace impactdic::sim::contact
