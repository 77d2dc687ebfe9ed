// The force along the normal as a function of the deflection, its rate and its history.
#pragma once

#include <impactdic/impact_model.h>

#include <memory>
#include <string>

namespace impactdic::sim::contact {

// What a contact remembers of its normal motion. A law gets it with every call and keeps nothing
// itself, so that one law serves many integrations at once.
struct NormalMemory {
  bool compressing = true;      // the deflection grows
  bool unloading = false;       // the deflection has passed a maximum and has not yet exceeded it
  double max_deflection_m = 0;  // the largest deflection so far, at which unloading began
  double max_force_n = 0;       // the spring's force there
  double residual_m = 0;        // deflection at which the unloading spring's force is zero
};

// One spring and one damper side by side. The two are separate so that the energy ledger can tell
// them apart. Deflection and rate are positive in compression, forces positive when they push.
class NormalLaw {
 public:
  virtual ~NormalLaw() = default;
  // The force that depends on the deflection only, on the branch that the memory names. N.
  virtual double spring_n(double deflection_m, const NormalMemory& memory) const = 0;
  // The force that depends on the rate. N.
  virtual double damper_n(double deflection_m, double rate_m_s, const NormalMemory& memory) const;
  // Work put into the spring since the first touch along the path that the memory tells, J. It
  // comes from the law (closed form or quadrature), not from the integration, so that the ledger's
  // residual checks the integration.
  virtual double work_j(double deflection_m, const NormalMemory& memory) const = 0;
  // The part of work_j that the spring would give back on unloading; the rest is plastic. J.
  virtual double stored_j(double deflection_m, const NormalMemory& memory) const;
  // The memory after the rate has turned from compression to restitution at this deflection. (The
  // integration clears `compressing` here, sets it when the rate turns back, and clears `unloading`
  // when the deflection exceeds max_deflection_m again.)
  virtual NormalMemory turn(double deflection_m, const NormalMemory& memory) const;
  // The next deflection above this one at which loading is not smooth (the integration restarts
  // there); infinite if there is none.
  virtual double next_kink_m(double deflection_m) const;
  // Has the sign of d(force)/dt while the contact is being compressed, and is smooth at the touch;
  // only asked of laws with a damper.
  virtual double force_growth(double deflection_m, double rate_m_s, double acceleration_m_s2) const;
  // Derivatives by the deflection of the spring's force and of the damper's force over the rate.
  struct Slopes {
    double spring = 0, spring_turn = 0;                    // first, second
    double damper = 0, damper_slope = 0, damper_turn = 0;  // zeroth, first, second
  };
  virtual Slopes slopes(double deflection_m, const NormalMemory& memory) const = 0;
  // What ends the contact: see RestitutionDamping; kNone for laws without a damper.
  virtual RestitutionDamping ending() const { return RestitutionDamping::kNone; }
  // Whether the surface is meant to pull before it lets go.
  virtual bool adhesive() const { return false; }
  // Why the law should not be used up to this deflection; empty where it may.
  virtual std::string out_of_range(double deflection_m) const = 0;
  // The duration of the contact, roughly (within a factor of about three): sets scales, s.
  virtual double duration_estimate_s(double mass_kg, double speed_m_s) const = 0;
  // The largest deflection, roughly, m.
  virtual double deflection_estimate_m(double mass_kg, double speed_m_s) const;
};

// "WHAT is VALUE, and the law holds to LIMIT", for out_of_range.
std::string beyond_limit(const char* what, double value, double limit);

// The law that the job names. Throws InvalidArgument.
std::unique_ptr<NormalLaw> make_normal_law(const ImpactJob& job);

// P = k delta^1.5 with a damper that grows with the contact: tsuji, kuwabara_kono, hunt_crossley.
std::unique_ptr<NormalLaw> make_damped_hertz(NormalModel model, const ContactParameters& contact,
                                             double radius_m, double mass_kg);
std::unique_ptr<NormalLaw> make_walton_braun(const ContactParameters& contact, double radius_m);
std::unique_ptr<NormalLaw> make_jkr(const ContactParameters& contact, double radius_m);

// Hertz (1882), P = k delta^1.5: 2.94328 delta_m / v and (5 m v^2 / (4 k))^0.4.
double hertz_duration_s(double mass_kg, double stiffness, double speed_m_s);
double hertz_deflection_m(double mass_kg, double stiffness, double speed_m_s);

// The elastic-plastic laws of normal_elastoplastic.cpp: jackson_green, kogut_etsion, thornton,
// stronge_elastoplastic. `radius_m` is the radius of the contact.
std::unique_ptr<NormalLaw> make_elastoplastic_law(NormalModel model,
                                                  const ContactParameters& contact,
                                                  double radius_m);

}  // namespace impactdic::sim::contact
