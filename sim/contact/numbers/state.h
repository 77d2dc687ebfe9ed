// What is integrated of a body in contact.
#pragma once

#include <array>
#include <cstddef>

namespace impactdic::sim::contact {

// The integrated state: BodyState, then the work integrals and the friction law's own.
enum StateIndex : std::size_t {
  kQt,
  kQn,
  kAngle,
  kVt,
  kVn,
  kOmega,
  kDamping,  // work taken by the damper, J
  kSlip,     // work taken by slip, J
  kTip,      // way of the contact point along the line of slip, m
  kSprings,  // ContactPoint::springs_m2
  kQb,       // across the plane of t and n
  kVb,
  kOmegaT,
  kOmegaN,
  kFlat,  // flattening of a shell, and its rate (shell.h)
  kFlatRate,
  kStateSize,
  // Of a rigid ball on its way out: how far its instants move with the inputs.
  kClock = kFlat
};
template <typename Real>
using ImpactStateOf = std::array<Real, kStateSize>;
using ImpactState = ImpactStateOf<double>;

}  // namespace impactdic::sim::contact
