// The equations of motion of a body in contact, for one normal and one tangential mode.
#pragma once

#include <array>
#include <cstddef>

#include "sim/contact/impact.h"
#include "sim/contact/law/friction_law.h"
#include "sim/contact/law/normal_law.h"

namespace impactdic::sim::contact {

// The integrated state: PlaneState, then the work integrals and the friction law's own.
enum StateIndex : std::size_t {
  kQt,
  kQn,
  kAngle,
  kVt,
  kVn,
  kOmega,
  kDamping,  // work taken by the damper, J
  kSlip,     // work taken by slip, J
  kTip,      // way of the contact point along the surface, m
  kSprings,  // ContactPoint::springs_m2
  kStateSize
};
using ImpactState = std::array<double, kStateSize>;

// m a_C = G + T, I_C alpha = r_CE x T (source Eqs 3.9, 4.7). The contact point E lies at r = (0,
// -R) of a ball; of a rod, R below the lower end of its axis, which turns with the body.
class ContactDynamics {
 public:
  ContactDynamics(const ImpactJob& job, const NormalLaw& normal, const FrictionLaw& friction);

  // The right-hand side, in the form that odeint calls.
  void operator()(const ImpactState& x, ImpactState& rate, double time_s) const;

  ContactPoint contact_point(const ImpactState& x) const;
  double spring_n(const ContactPoint& at) const {
    return normal_.spring_n(at.deflection_m, memory);
  }
  // Spring and damper, negative where the law pulls.
  double normal_force_n(const ContactPoint& at) const;

  double gravity_t() const { return gravity_t_; }
  double gravity_n() const { return gravity_n_; }

  NormalMemory memory;
  mutable long evaluations = 0;

 private:
  struct Arm {
    double t, n;
  };
  Arm arm(double angle_rad) const;

  const NormalLaw& normal_;
  const FrictionLaw& friction_;
  double mass_, inverse_mass_, inverse_inertia_;
  double gravity_t_, gravity_n_;
  bool rod_;
  double cap_;          // rods: radius of the round end, which lies below the axis's end
  double reach_;        // radius, or half the rod's length
  double start_angle_;  // rods: of the axis at t = 0
};

}  // namespace impactdic::sim::contact
