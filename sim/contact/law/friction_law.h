// The force along the surface as a function of the contact's motion and of a mode (sliding,
// sticking, ...) that changes only at events.
#pragma once

#include <impactdic/impact_model.h>

#include <array>
#include <memory>

#include "sim/contact/numbers/numbers.h"

namespace impactdic::sim::contact {

// All that a friction law may look at, at one instant. Tangential figures are those along the line
// of slip (contact_dynamics.h).
template <typename Real>
struct ContactPointOf {
  Real deflection_m{}, rate_m_s{};  // of the normal contact, positive in compression
  Real spring_n{};                  // the normal law's spring, not below zero
  Real normal_n{};                  // spring and damper, not below zero
  Real law_n{};                     // the same, negative where the law pulls
  Real centre_vt_m_s{};
  Real tip_vt_m_s{};         // tangential velocity of the contact point
  Real tip_m{};              // its integral since the contact began
  Real springs_m2{};         // the integral of Traction::springs_rate_m2_s
  Real acceleration_m_s2{};  // of the deflection
  bool compressing = true;   // the deflection grows
  Real damping_n_s_per_m{};  // of the damper at present; 0 while it rests
  Real mobility_per_kg{};    // d(tip_vt)/dt = mobility force - drift
  Real drift_m_s2{};
  Real holding_n{};  // the force that would keep centre_vt_m_s as it is
  // For laws that ask for them, of balls: the first and second derivative by time of the spring's
  // force and of spring and damper together.
  Real spring_rate_n_s{}, spring_turn_n_s2{};
  Real normal_rate_n_s{}, normal_turn_n_s2{};

  // The force that would keep tip_vt_m_s as it is.
  Real rolling_n() const { return drift_m_s2 / mobility_per_kg; }
};

template <typename Real>
struct TractionOf {
  Real force_n{};
  Real dissipation_w{};      // by slip; negative where the rule feeds energy in
  Real springs_rate_m2_s{};  // of the law's own state, ContactPoint::springs_m2
  Real centre_force_n{};     // acts on the centre without a moment (one published rule needs it)
};

template <typename Real>
class FrictionLawOf {
 public:
  static constexpr int kMaxGuards = 3;
  using Guards = std::array<Real, kMaxGuards>;
  using ContactPoint = ContactPointOf<Real>;
  using Traction = TractionOf<Real>;

  virtual ~FrictionLawOf() = default;
  // Chooses the first mode; called when a contact begins.
  virtual void begin(const ContactPoint& at, In<Real> time_s) = 0;
  virtual Traction traction(const ContactPoint& at) const = 0;
  // Fills the functions that are positive while the mode lasts and returns how many they are. One
  // that falls through zero ends the mode.
  virtual int guards(const ContactPoint& at, Guards& values) const = 0;
  // Changes the mode after that guard has crossed.
  virtual void cross(int guard, const ContactPoint& at) = 0;
  // The normal force jumps, or its rate does, at one instant.
  virtual void jump(const ContactPoint& /*before*/, const ContactPoint& /*after*/) {}
  // What the last change of mode dissipated in an instant, J.
  virtual Real lost_at_once_j() const { return Real(0); }
  // Whether it looks at the derivatives of the normal force.
  virtual bool asks_force_rate() const { return false; }
  // The mode's name, as in Phase::name.
  virtual const char* mode() const = 0;
  // Told of every accepted step, for laws that remember the path.
  virtual void step(const ContactPoint&, In<Real> /*time_s*/) {}
  // Energy stored in tangential springs, J.
  virtual Real stored_j(const ContactPoint&, In<Real> /*time_s*/) const { return Real(0); }
};

template <typename Real>
using FrictionLawPtr = std::unique_ptr<FrictionLawOf<Real>>;
using FrictionLaw = FrictionLawOf<double>;
using ContactPoint = ContactPointOf<double>;

// The law that the job names. `speed_t`, `speed_n`: of the mass centre when the contact begins (the
// published rules of chapter 4 scale with them).
template <typename Real>
FrictionLawPtr<Real> make_friction_law(const ImpactJob& job, const JobNumbers<Real>& numbers,
                                       const Real& speed_t_m_s, const Real& speed_n_m_s);
// Partial slip. `hertz_stiffness`: of the Hertz contact whose circle carries the normal force,
// N/m^1.5; `hertz_spring`: the normal law's spring is that one.
template <typename Real>
FrictionLawPtr<Real> make_maw_barber_fawcett(const ImpactJob& job, const JobNumbers<Real>& numbers,
                                             const Real& hertz_stiffness, bool hertz_spring);
template <typename Real>
FrictionLawPtr<Real> make_tangential_spring(const Real& stiffness_n_per_m,
                                            const Real& friction_kinetic,
                                            const Real& friction_static);

}  // namespace impactdic::sim::contact
