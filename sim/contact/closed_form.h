// Impacts that have a formula: references for the integrated models, and start values for fits.
#pragma once

#include <impactdic/impact_model.h>

namespace impactdic::sim::contact {

// A ball whose normal velocity is multiplied by -restitution and the velocity of whose contact
// point by -tangential_restitution. Cross (2002): vt'/vt = (1 - kappa e_x)/(1 + kappa) without
// spin.
ImpactVelocities cross_rebound(const ImpactBody& ball, const ImpactVelocities& before,
                               double restitution, double tangential_restitution);
// Garwin (1969): both are 1, a superball.
ImpactVelocities garwin_rebound(const ImpactBody& ball, const ImpactVelocities& before);
// Sliding with J_t = mu (1 + e) m |vn| unless that would exceed what reaches
// `tangential_restitution`. Walton (1993) with beta_0; Brody (1984) with 0: slide, else roll.
ImpactVelocities walton_rebound(const ImpactBody& ball, const ImpactVelocities& before,
                                double restitution, double friction, double tangential_restitution);
ImpactVelocities brody_rebound(const ImpactBody& ball, const ImpactVelocities& before,
                               double restitution, double friction);

// Stronge's energetic restitution (1990): the surface gives back e*^2 of the work that the normal
// impulse did in compression; Coulomb friction slides, sticks or turns round as the impulse grows.
// (arm_t, arm_n): the contact point seen from the mass centre, m.
ImpactVelocities stronge_rebound(const ImpactBody& body, double arm_t_m, double arm_n_m,
                                 const ImpactVelocities& before, double energetic_restitution,
                                 double friction);

// Linear spring with a damper in compression only, without gravity (source section 3.1; any damping
// ratio zeta = b / (2 sqrt(k m))).
struct LinearImpact {
  double restitution = 0;          // exp(-zeta acos(zeta)/sqrt(1 - zeta^2))
  double contact_s = 0;            // t_m + pi / (2 omega_0)
  double t_max_compression_s = 0;  // acos(zeta) / (omega_0 sqrt(1 - zeta^2))
  double max_deflection_m = 0;     // e v / omega_0
};
LinearImpact linear_impact(double mass_kg, double stiffness_n_per_m, double damping_n_s_per_m,
                           double speed_m_s);
// The same law damped to the end, zeta < 1: the restitution if the contact ends at zero force,
// exp(-2 zeta acos(zeta)/sqrt(1 - zeta^2)), or at zero deflection, exp(-pi zeta/sqrt(1 - zeta^2)).
double damped_restitution(double damping_ratio, RestitutionDamping damping);

struct SpringDamperParameters {
  double stiffness = 0;  // N/m, or N/m^1.5 for Hertz
  double damping_n_s_per_m = 0;
};
// The inverse of linear_impact: (e, T) fix (k, b) uniquely. Throws InvalidArgument unless
// 0 < e <= 1 and T > 0.
SpringDamperParameters linear_parameters(double mass_kg, double restitution, double contact_s);
// Dignall and Haake (2000), Kelvin-Voigt damped throughout, contact to zero deflection:
// c = -(2 m / T) ln e, k = m (pi^2 + ln^2 e) / T^2.
SpringDamperParameters kelvin_voigt_parameters(double mass_kg, double restitution,
                                               double contact_s);
// The same law ended where its force is zero, before the surface would pull:
// e = exp(-2 zeta theta/sqrt(1 - zeta^2)), T = 2 theta/(omega_0 sqrt(1 - zeta^2)), cos theta =
// zeta.
SpringDamperParameters force_free_parameters(double mass_kg, double restitution, double contact_s);
// The inverse of an impact with F = k delta^1.5 + b delta', without gravity: e depends on
// b/(m^.6 k^.4 v^.2) alone. Throws InvalidArgument unless 0.05 <= e <= 1 and T > 0.
SpringDamperParameters hertz_parameters(double mass_kg, double speed_m_s, double restitution,
                                        double contact_s, RestitutionDamping damping);

// Hertz (1882), F = k delta^1.5: delta_m = (5 m v^2 / (4 k))^0.4 and
// T = 0.8 sqrt(pi) Gamma(0.4)/Gamma(0.9) delta_m / v = 2.94328 delta_m / v.
double hertz_max_deflection_m(double mass_kg, double stiffness_n_per_m1p5, double speed_m_s);
double hertz_contact_s(double mass_kg, double stiffness_n_per_m1p5, double speed_m_s);

// Maw, Barber and Fawcett (1976): psi = 2 (1 - nu)/(mu (2 - nu)) v_t/v_n of the contact point and
// chi = (1 - nu)(1 + 1/kappa)/(2 - nu). In gross slip, psi >= 4 chi - 1: psi' = psi - 4 chi.
double maw_psi(double poisson, double friction, double tip_vt_m_s, double speed_n_m_s);
double maw_chi(double poisson, double inertia_factor);

}  // namespace impactdic::sim::contact
