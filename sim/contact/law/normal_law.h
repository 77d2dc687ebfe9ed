// The force along the normal as a function of the deflection, its rate and its history.
#pragma once

#include <impactdic/impact_model.h>

#include <memory>
#include <string>

#include "sim/contact/numbers/numbers.h"

namespace impactdic::sim::contact {

// What a contact remembers of its normal motion. A law gets it with every call and keeps nothing
// itself, so that one law serves many integrations at once.
template <typename Real>
struct NormalMemoryOf {
  bool compressing = true;  // the deflection grows
  bool unloading = false;   // the deflection has passed a maximum and has not yet exceeded it
  Real max_deflection_m{};  // the largest deflection so far, at which unloading began
  Real max_force_n{};       // the spring's force there
  Real residual_m{};        // deflection at which the unloading spring's force is zero
};

// One spring and one damper side by side. The two are separate so that the energy ledger can tell
// them apart. Deflection and rate are positive in compression, forces positive when they push.
template <typename Real>
class NormalLawOf {
 public:
  using NormalMemory = NormalMemoryOf<Real>;

  virtual ~NormalLawOf() = default;
  // The force that depends on the deflection only, on the branch that the memory names. N.
  virtual Real spring_n(In<Real> deflection_m, const NormalMemory& memory) const = 0;
  // The force that depends on the rate. N.
  virtual Real damper_n(In<Real> deflection_m, In<Real> rate_m_s, const NormalMemory& memory) const;
  // Work put into the spring since the first touch along the path that the memory tells, J. It
  // comes from the law (closed form or quadrature), not from the integration, so that the ledger's
  // residual checks the integration.
  virtual Real work_j(In<Real> deflection_m, const NormalMemory& memory) const = 0;
  // The part of work_j that the spring would give back on unloading; the rest is plastic. J.
  virtual Real stored_j(In<Real> deflection_m, const NormalMemory& memory) const;
  // The memory after the rate has turned from compression to restitution at this deflection. (The
  // integration clears `compressing` here, sets it when the rate turns back, and clears `unloading`
  // when the deflection exceeds max_deflection_m again.)
  virtual NormalMemory turn(In<Real> deflection_m, const NormalMemory& memory) const;
  // The next deflection above this one at which loading is not smooth (the integration restarts
  // there); infinite if there is none.
  virtual Real next_kink_m(In<Real> deflection_m) const;
  // Has the sign of d(force)/dt while the contact is being compressed, and is smooth at the touch;
  // only asked of laws with a damper.
  virtual Real force_growth(In<Real> deflection_m, In<Real> rate_m_s,
                            In<Real> acceleration_m_s2) const;
  // Derivatives by the deflection of the spring's force and of the damper's force over the rate.
  struct Slopes {
    Real spring{}, spring_turn{};                  // first, second
    Real damper{}, damper_slope{}, damper_turn{};  // zeroth, first, second
  };
  virtual Slopes slopes(In<Real> deflection_m, const NormalMemory& memory) const = 0;
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

template <typename Real>
using NormalLawPtr = std::unique_ptr<NormalLawOf<Real>>;
using NormalLaw = NormalLawOf<double>;

// The law that the job names. Throws InvalidArgument.
template <typename Real>
NormalLawPtr<Real> make_normal_law(const ImpactJob& job, const JobNumbers<Real>& numbers);

// P = k delta^1.5 with a damper that grows with the contact: tsuji, kuwabara_kono, hunt_crossley.
template <typename Real>
NormalLawPtr<Real> make_damped_hertz(const ImpactJob& job, const JobNumbers<Real>& numbers);
template <typename Real>
NormalLawPtr<Real> make_walton_braun(const JobNumbers<Real>& numbers);
template <typename Real>
NormalLawPtr<Real> make_jkr(const JobNumbers<Real>& numbers);
// The elastic-plastic laws of normal_elastoplastic.cpp: jackson_green, kogut_etsion, thornton,
// stronge_elastoplastic.
template <typename Real>
NormalLawPtr<Real> make_elastoplastic_law(const ImpactJob& job, const JobNumbers<Real>& numbers);

// Hertz (1882), P = k delta^1.5: 2.94328 delta_m / v and (5 m v^2 / (4 k))^0.4.
double hertz_duration_s(double mass_kg, double stiffness, double speed_m_s);
double hertz_deflection_m(double mass_kg, double stiffness, double speed_m_s);

}  // namespace impactdic::sim::contact
