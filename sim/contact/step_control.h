// The step-size control of a contact's integration: what counts as an error.
#pragma once

#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>

#include "sim/contact/contact_dynamics.h"

namespace impactdic::sim::contact {

template <typename Real>
using Dopri5 = boost::numeric::odeint::runge_kutta_dopri5<ImpactStateOf<Real>>;

// How long the contact lasts and how large each state becomes, roughly.
struct ContactScales {
  double duration_s;
  ImpactState state;
};
// `touch_rate_m_s`: of the deflection as the contact begins.
template <typename Real>
ContactScales contact_scales(const ImpactJob& job, const NormalLawOf<Real>& normal,
                             double touch_rate_m_s, const ImpactState& start);

// The error of a step against each state's own scale, so that metres, radians and joules are all
// met to the same relative accuracy, also where a state passes through zero. Derivatives, which are
// by parts of their inputs' own size, are to be as exact as the state.
template <typename Real>
class ScaledError {
 public:
  using State = ImpactStateOf<Real>;
  using value_type = double;
  using algebra_type = typename Dopri5<Real>::algebra_type;
  using operations_type = typename Dopri5<Real>::operations_type;

  ScaledError() = default;
  // Steps shorter than `shortest_s` are exact in their derivatives whatever the estimate: where a
  // derivative is infinite for an instant, no step is short enough.
  ScaledError(double tolerance, const ImpactState& scale, double shortest_s)
      : scale_(scale), shortest_s_(shortest_s) {
    // Errors of a few hundred steps add up: a tenth per step keeps the sum near the tolerance.
    for (std::size_t i = 0; i < kStateSize; ++i) inverse_[i] = 10 / (tolerance * scale[i]);
  }

  double error(algebra_type&, [[maybe_unused]] const State& x, const State&, const State& x_error,
               [[maybe_unused]] double step_s) const {
    double largest = 0;
    for (std::size_t i = 0; i < kStateSize; ++i) {
      const double scaled = std::abs(value_of(x_error[i])) * inverse_[i];
      if (!(scaled <= largest)) largest = scaled;
      if constexpr (kHasDerivatives<Real>) {
        if (step_s < shortest_s_) continue;
        const auto size = (1 + x[i].v.array().abs() / scale_[i]) / inverse_[i];
        const double worst = (x_error[i].v.array().abs() / size).maxCoeff();
        if (!(worst <= largest)) largest = worst;
      }
    }
    return std::isnan(largest) ? 1e9 : largest;
  }

 private:
  ImpactState scale_{}, inverse_{};
  double shortest_s_ = 0;
};

}  // namespace impactdic::sim::contact
