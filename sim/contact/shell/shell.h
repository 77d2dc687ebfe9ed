// A ball whose shell flattens: two masses, a spring and a damper between them, in series with the
// normal law.
//
// With c the mass centre and d the flattening, the part of mass f m that lies on the surface stands
// at y = c - (1 - f) d below the surface's place at rest, and the rest, whose outline a camera
// sees, at c + f d. Of the surface's force S and the shell's P = k d + b d'
//   m c'' = -S      d'' = -P/(f (1 - f) m) + S/(f m)
// Out of contact the ball swings in its own mode, omega^2 = k/(f (1 - f) m).
#pragma once

#include "sim/contact/numbers/numbers.h"
#include "sim/contact/numbers/state.h"

namespace impactdic::sim::contact {

template <typename Real>
class Shell {
 public:
  using State = ImpactStateOf<Real>;

  // Of the job's numbers; a ball without a shell is rigid.
  explicit Shell(const JobNumbers<Real>& numbers);

  bool given() const { return given_; }
  // How far the outline's centre is below the mass centre, or its rate.
  Real lag(const Real& flattening) const { return fraction_ * flattening; }
  // How far the part in contact is above it, or its rate.
  Real reach(const Real& flattening) const { return (1.0 - fraction_) * flattening; }
  // d'' under the surface's force.
  Real acceleration(const State& x, const Real& pressed_n) const;
  // y'' of the part in contact, but for the weight.
  Real contact_acceleration(const State& x, const Real& pressed_n) const;
  Real dissipation_w(const State& x) const { return damping_ * x[kFlatRate] * x[kFlatRate]; }
  // Of the spring and of the two masses' motion against each other.
  Real energy_j(const State& x) const;
  // Swings for a while out of contact; what the damper takes is added to x[kDamping].
  void swing(State& x, const Real& elapsed) const;

  // How flat it becomes in a flight of so long, where it turns back meanwhile; else 0.
  Real flattest_in_flight(const State& x, const Real& flight_s) const;

  struct Touch {
    Real after_s{};          // infinite: never
    bool same_blow = false;  // the ball has not gone farther meanwhile than it swings
  };
  // When the part in contact comes back to the surface, of a ball that has just left it or flies,
  // without air.
  Touch next_touch(const State& x, const Real& gravity_n) const;

 private:
  Real force_n(const State& x) const { return stiffness_ * x[kFlat] + damping_ * x[kFlatRate]; }

  bool given_ = false;
  Real stiffness_{}, damping_{}, fraction_{};
  Real flat_kg_{}, reduced_kg_{};
};

}  // namespace impactdic::sim::contact
