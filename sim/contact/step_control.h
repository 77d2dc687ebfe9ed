// The step-size control of a contact's integration: what counts as an error.
#pragma once

#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>

#include "sim/contact/contact_dynamics.h"

namespace impactdic::sim::contact {

using Dopri5 = boost::numeric::odeint::runge_kutta_dopri5<ImpactState>;

// How long the contact lasts and how large each state becomes, roughly.
struct ContactScales {
  double duration_s;
  ImpactState state;
};
ContactScales contact_scales(const ImpactJob& job, const NormalLaw& normal,
                             const ContactPoint& touch, const ImpactState& start);

// The error of a step against each state's own scale, so that metres, radians and joules are all
// met to the same relative accuracy, also where a state passes through zero.
class ScaledError {
 public:
  using value_type = double;
  using algebra_type = Dopri5::algebra_type;
  using operations_type = Dopri5::operations_type;

  ScaledError() = default;
  ScaledError(double tolerance, const ImpactState& scale) {
    // Errors of a few hundred steps add up: a tenth per step keeps the sum near the tolerance.
    for (std::size_t i = 0; i < kStateSize; ++i) inverse_[i] = 10 / (tolerance * scale[i]);
  }

  double error(algebra_type&, const ImpactState&, const ImpactState&, const ImpactState& x_error,
               double) const {
    double largest = 0;
    for (std::size_t i = 0; i < kStateSize; ++i) {
      const double scaled = std::abs(x_error[i]) * inverse_[i];
      if (!(scaled <= largest)) largest = scaled;
    }
    return std::isnan(largest) ? 1e9 : largest;
  }

 private:
  ImpactState inverse_{};
};

}  // namespace impactdic::sim::contact
