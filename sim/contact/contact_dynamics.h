// The equations of motion of a body in contact, for one normal and one tangential mode.
//
// Friction acts along a line in the surface, that of the contact point's slip, and its laws know
// the motion along this line alone. A ball looks alike from all sides, so the line stays as it is
// while nothing else pushes across it; the weight on a slope may, and then it turns with the slip.
#pragma once

#include "sim/contact/impact.h"
#include "sim/contact/law/friction_law.h"
#include "sim/contact/law/normal_law.h"
#include "sim/contact/law/turning_resistance.h"
#include "sim/contact/numbers/state.h"
#include "sim/contact/shell/shell.h"

namespace impactdic::sim::contact {

// A unit vector in the surface, along t and b.
template <typename Real>
struct SlipLineOf {
  Real t{1}, b{};
};
using SlipLine = SlipLineOf<double>;

// m a_C = G + T, I_C alpha = r_CE x T (source Eqs 3.9, 4.7). The contact point E lies at r = (0,
// -R) of a ball; of a rod, R below the lower end of its axis, which turns with the body.
template <typename Real>
class ContactDynamicsOf {
 public:
  using State = ImpactStateOf<Real>;
  using SlipLine = SlipLineOf<Real>;
  using ContactPoint = ContactPointOf<Real>;

  ContactDynamicsOf(const JobNumbers<Real>& numbers, const NormalLawOf<Real>& normal,
                    const FrictionLawOf<Real>& friction);

  // The right-hand side, in the form that odeint calls.
  void operator()(const State& x, State& rate, double time_s) const;

  ContactPoint contact_point(const State& x) const;

  // Lays the line of slip at the touch: along t in plane motion. Whether it turns thereafter.
  // `remembers`: friction is of springs, which know no slip that turns.
  void aim(const State& touch, bool remembers);
  bool turning() const { return turning_; }
  // The slip as it is now becomes the line, which goes on turning.
  void follow(const State& x) { line_ = line(x); }
  // The contact point has stopped. What may move it from here on is the weight, down the slope, or
  // the resistance to rolling; a force that keeps its direction is the exception.
  void stop_turning(const State& x, bool keep_line);
  // Slip across plane motion has ended for good.
  void stop_across() { line_.b = Real(0), across_ = false; }
  // It has not: it turns round faster than a step shows, since friction is less than the weight.
  void turn_on(const State& x);
  // Takes away the slip that a turning line leaves when it stops, about 1e-9 of the speed: the
  // energy of it is the square of that. Balls.
  void rest(State& x) const;
  SlipLine line(const State& x) const;
  // Velocity of the contact point along the surface, of its two components.
  Real tip_t(const State& x) const { return x[kVt] - x[kOmega] * arm(x[kAngle]).n; }
  Real tip_b(const State& x) const { return x[kVb] + x[kOmegaT] * arm(x[kAngle]).n; }

  Real gravity_t() const { return gravity_t_; }
  Real gravity_n() const { return gravity_n_; }

  NormalMemoryOf<Real> memory;
  mutable long evaluations = 0;

 private:
  void add_force_rates(ContactPoint& at) const;
  SlipLine line_at_rest(const State& x) const;
  // Something beside friction pushes the contact point along the surface.
  bool pushed() const { return gravity_t_ != 0 || resistance_.of_rolling(); }
  struct Arm {
    Real t, n;
  };
  Arm arm(const Real& angle_rad) const;

  const NormalLawOf<Real>& normal_;
  const FrictionLawOf<Real>& friction_;
  Shell<Real> shell_;
  TurningResistance<Real> resistance_;
  Real mass_, inverse_mass_, inverse_inertia_;
  Real gravity_t_, gravity_n_;
  bool rod_;
  Real cap_;          // rods: radius of the round end, which lies below the axis's end
  Real reach_;        // radius, or half the rod's length
  Real start_angle_;  // rods: of the axis at t = 0
  bool rates_;        // the friction law asks for the force's derivatives
  SlipLine line_;
  bool turning_ = false;
  bool across_ = false;  // plane motion: a little slip across turns the line, and the weight both
};
using ContactDynamics = ContactDynamicsOf<double>;

}  // namespace impactdic::sim::contact
