// The equations of motion of a body in contact, for one normal and one tangential mode.
//
// Friction acts along a line in the surface, that of the contact point's slip, and its laws know
// the motion along this line alone. A ball looks alike from all sides, so the line stays as it is
// while nothing else pushes across it; the weight on a slope may, and then it turns with the slip.
#pragma once

#include <array>
#include <cstddef>

#include "sim/contact/impact.h"
#include "sim/contact/law/friction_law.h"
#include "sim/contact/law/normal_law.h"

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
  kStateSize
};
using ImpactState = std::array<double, kStateSize>;

// A unit vector in the surface, along t and b.
struct SlipLine {
  double t = 1, b = 0;
};

// m a_C = G + T, I_C alpha = r_CE x T (source Eqs 3.9, 4.7). The contact point E lies at r = (0,
// -R) of a ball; of a rod, R below the lower end of its axis, which turns with the body.
class ContactDynamics {
 public:
  ContactDynamics(const ImpactJob& job, const NormalLaw& normal, const FrictionLaw& friction);

  // The right-hand side, in the form that odeint calls.
  void operator()(const ImpactState& x, ImpactState& rate, double time_s) const;

  ContactPoint contact_point(const ImpactState& x) const;

  // Lays the line of slip at the touch: along t in plane motion. Whether it turns thereafter.
  void aim(const ImpactState& touch);
  bool turning() const { return turning_; }
  // The slip as it is now becomes the line, which goes on turning.
  void follow(const ImpactState& x) { line_ = line(x); }
  // The contact point has stopped. What may move it from here on is the weight, down the slope; a
  // force that keeps its direction is the exception.
  void stop_turning(bool keep_line);
  // It has not: it turns round faster than a step shows, since friction is less than the weight.
  void turn_on(const ImpactState& x);
  // Takes away the slip that a turning line leaves when it stops, about 1e-9 of the speed: the
  // energy of it is the square of that. Balls.
  void rest(ImpactState& x) const;
  SlipLine line(const ImpactState& x) const;
  // Velocity of the contact point along the surface, of its two components.
  double tip_t(const ImpactState& x) const { return x[kVt] - x[kOmega] * arm(x[kAngle]).n; }
  double tip_b(const ImpactState& x) const { return x[kVb] + x[kOmegaT] * arm(x[kAngle]).n; }

  double gravity_t() const { return gravity_t_; }
  double gravity_n() const { return gravity_n_; }

  NormalMemory memory;
  mutable long evaluations = 0;

 private:
  void add_force_rates(ContactPoint& at) const;
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
  bool rates_;          // the friction law asks for the force's derivatives
  SlipLine line_;
  bool turning_ = false;
};

}  // namespace impactdic::sim::contact
