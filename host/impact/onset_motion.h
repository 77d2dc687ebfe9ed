// The height of a ball before and after a surface begins to act on it, for the laws of the onset
// (contact_edge.h), with derivatives where T is a dual number. Internal to the impact analysis.
#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <cmath>
#include <vector>

namespace impactdic::impact {

// What is added to the power law; v is the speed, v0 that at the touch.
enum class Damper {
  kStriking,  // A v/v0
  kFading,    // B (1 - v/v0)
  kDragging,  // as fading, on a surface that is still dented where the force has faded: the power
              // law's deflection then counts from where K x^p = B
};

template <typename T>
struct OnsetLaw {
  T touch, height, speed;          // speed towards the surface, at the touch
  T stiffness, exponent, damping;  // in units of the scales below
  Damper damper;
  double gravity, deflection_scale, acceleration_scale;
};

inline double value_of(double x) { return x; }
template <int N>
double value_of(const ceres::Jet<double, N>& x) {
  return x.a;
}

// In a time that runs from flight into contact.
template <typename T>
class OnsetMotion {
 public:
  OnsetMotion(const OnsetLaw<T>& law, double until) : law_(law) {
    using std::pow;
    if (law.damper == Damper::kDragging && law.damping > 0.0 && law.stiffness > 0.0) {
      dent_ = pow(law.damping / law.stiffness, 1.0 / law.exponent);
    }
    // Enough for 1e-6 of the deflection at the deepest point.
    constexpr int kSteps = 64;
    step_ = std::max(T(until - law.touch), T(1e-3)) / static_cast<double>(kSteps);
    nodes_.reserve(kSteps + 1);
    State y{T(0.0), law.speed};
    nodes_.push_back(y);
    // One step in units of step_: the time of the stepper is no dual number.
    const auto rates = [this](const State& at, State& rate, double) {
      rate = {step_ * at[1], step_ * acceleration(at)};
    };
    boost::numeric::odeint::runge_kutta4<State> stepper;
    for (int i = 0; i < kSteps; ++i) {
      stepper.do_step(rates, y, static_cast<double>(i), 1.0);
      nodes_.push_back(y);
    }
  }

  T height(double time) const {
    const T since = time - law_.touch;
    if (since <= 0.0) {
      return law_.height - law_.speed * since + law_.gravity * since * since / 2.0;
    }
    // Cubic Hermite between the nodes.
    const auto last = static_cast<double>(nodes_.size() - 2);
    const double cell = std::min(std::floor(value_of(since) / value_of(step_)), last);
    const auto i = static_cast<std::size_t>(cell);
    const T u = since / step_ - cell, w = 1.0 - u;
    const State &a = nodes_[i], &b = nodes_[i + 1];
    const T x = w * w * (1.0 + 2.0 * u) * a[0] + u * u * (3.0 - 2.0 * u) * b[0] +
                step_ * u * w * (w * a[1] - u * b[1]);
    return law_.height - x;
  }

 private:
  using State = std::array<T, 2>;  // deflection and its rate

  T acceleration(const State& y) const {
    using std::pow;
    const T x = std::max(y[0], T(0.0)) / law_.deflection_scale + dent_;
    const T slow = y[1] / law_.speed;
    // Where it is zero a power has no derivative by its exponent.
    T force = x > 0.0 ? law_.stiffness * pow(x, law_.exponent) : T(0.0);
    if (dent_ > 0.0) {
      force -= law_.damping * slow;
    } else {
      force += law_.damping * (law_.damper == Damper::kStriking ? slow : 1.0 - slow);
    }
    return -law_.gravity - law_.acceleration_scale * force;
  }

  OnsetLaw<T> law_;
  T step_{}, dent_ = T(0.0);
  std::vector<State> nodes_;
};

}  // namespace impactdic::impact
