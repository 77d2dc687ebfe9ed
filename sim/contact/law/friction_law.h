// The force along the surface as a function of the contact's motion and of a mode (sliding,
// sticking, ...) that changes only at events.
#pragma once

#include <impactdic/impact_model.h>

#include <array>
#include <memory>

namespace impactdic::sim::contact {

// All that a friction law may look at, at one instant. Tangential figures are those along the line
// of slip (contact_dynamics.h).
struct ContactPoint {
  double deflection_m = 0, rate_m_s = 0;  // of the normal contact, positive in compression
  double spring_n = 0;                    // the normal law's spring, not below zero
  double normal_n = 0;                    // spring and damper, not below zero
  double law_n = 0;                       // the same, negative where the law pulls
  double centre_vt_m_s = 0;
  double tip_vt_m_s = 0;         // tangential velocity of the contact point
  double tip_m = 0;              // its integral since the contact began
  double springs_m2 = 0;         // the integral of Traction::springs_rate_m2_s
  double acceleration_m_s2 = 0;  // of the deflection
  bool compressing = true;       // the deflection grows
  double damping_n_s_per_m = 0;  // of the damper at present; 0 while it rests
  double mobility_per_kg = 0;    // d(tip_vt)/dt = mobility force - drift
  double drift_m_s2 = 0;
  double holding_n = 0;  // the force that would keep centre_vt_m_s as it is
  // For laws that ask for them, of balls: the first and second derivative by time of the spring's
  // force and of spring and damper together.
  double spring_rate_n_s = 0, spring_turn_n_s2 = 0;
  double normal_rate_n_s = 0, normal_turn_n_s2 = 0;

  // The force that would keep tip_vt_m_s as it is.
  double rolling_n() const { return drift_m_s2 / mobility_per_kg; }
};

struct Traction {
  double force_n = 0;
  double dissipation_w = 0;      // by slip; negative where the rule feeds energy in
  double springs_rate_m2_s = 0;  // of the law's own state, ContactPoint::springs_m2
  double centre_force_n = 0;  // acts on the centre without a moment (one published rule needs it)
};

class FrictionLaw {
 public:
  static constexpr int kMaxGuards = 3;
  using Guards = std::array<double, kMaxGuards>;

  virtual ~FrictionLaw() = default;
  // Chooses the first mode; called when a contact begins.
  virtual void begin(const ContactPoint& at, double time_s) = 0;
  virtual Traction traction(const ContactPoint& at) const = 0;
  // Fills the functions that are positive while the mode lasts and returns how many they are. One
  // that falls through zero ends the mode.
  virtual int guards(const ContactPoint& at, Guards& values) const = 0;
  // Changes the mode after that guard has crossed.
  virtual void cross(int guard, const ContactPoint& at) = 0;
  // The normal force jumps, or its rate does, at one instant.
  virtual void jump(const ContactPoint& /*before*/, const ContactPoint& /*after*/) {}
  // What the last change of mode dissipated in an instant, J.
  virtual double lost_at_once_j() const { return 0; }
  // Whether it looks at the derivatives of the normal force.
  virtual bool asks_force_rate() const { return false; }
  // The mode's name, as in Phase::name.
  virtual const char* mode() const = 0;
  // Told of every accepted step, for laws that remember the path.
  virtual void step(const ContactPoint&, double /*time_s*/) {}
  // Energy stored in tangential springs, J.
  virtual double stored_j(const ContactPoint&, double /*time_s*/) const { return 0; }
};

// The law that the job names. `speed_t`, `speed_n`: of the mass centre when the contact begins (the
// published rules of chapter 4 scale with them).
std::unique_ptr<FrictionLaw> make_friction_law(const ImpactJob& job, double speed_t_m_s,
                                               double speed_n_m_s);
// Partial slip. `hertz_stiffness`: of the Hertz contact whose circle carries the normal force,
// N/m^1.5; `hertz_spring`: the normal law's spring is that one.
std::unique_ptr<FrictionLaw> make_maw_barber_fawcett(const ContactParameters& contact,
                                                     double hertz_stiffness, bool hertz_spring,
                                                     double radius_m);
std::unique_ptr<FrictionLaw> make_tangential_spring(double stiffness_n_per_m,
                                                    double friction_kinetic,
                                                    double friction_static);

}  // namespace impactdic::sim::contact
