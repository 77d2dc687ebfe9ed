// Elastic-plastic normal contact of a spherical tip with a flat: loading beyond the yield point,
// the deformation that stays, and the elastic way back. Pure functions of the compression and of
// the largest compression so far; who integrates keeps that memory.
//
// x = compression / critical compression throughout. Sources, by first author and year:
//   Jackson & Green 2005 (loading), Jackson, Green & Marghitu 2010 (residual),
//   Kogut & Etsion 2002 (loading), Etsion, Kligerman & Kadin 2005 (residual, unloading exponent),
//   Thornton 1997 (loading, unloading, restitution), Johnson 1985 (restitution),
//   Stronge 2000 (loading).
#pragma once

#include <impactdic/rod_model.h>

#include <string>

#include "sim/contact/numbers/real.h"

namespace impactdic::sim::contact {

// 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2, in pascal.
double effective_modulus_pa(double young1_pa, double poisson1, double young2_pa, double poisson2);

// An ElasticPlasticSurface whose numbers have derivatives.
template <typename Real>
struct SurfaceNumbers {
  Real radius_m{}, effective_modulus_pa{}, yield_strength_pa{}, poisson{};
};

// P(compression) on the way in and on the way out. Thornton's and Stronge's loading have their own
// residual and ignore `residual`. Force and deformation are zero or positive.
template <typename Real>
class ElasticPlasticLawOf {
 public:
  using Numbers =
      std::conditional_t<kHasDerivatives<Real>, SurfaceNumbers<Real>, ElasticPlasticSurface>;

  ElasticPlasticLawOf(const Numbers& surface, PlasticLoading loading, ResidualLaw residual);

  // Where yield begins: w_c = (pi C Sy / 2 E*)^2 R with C = 1.295 exp(0.736 nu), or for Stronge
  // with the mean pressure 2/3 C Sy = 1.1 Sy, and its force P_c = 4/3 (R/E*)^2 (pi C Sy / 2)^3.
  Real critical_compression_m() const { return critical_compression_m_; }
  Real critical_force_n() const { return critical_force_n_; }
  // Force at compression `w_m`, growing past every earlier one. Zero for w_m <= 0.
  // Jackson & Green jump by +0.66 % at x = 1.9 (nu 0.29), Kogut & Etsion by +3 % and +1.7 % at
  // x = 1 and 6: the published fits do so.
  Real loading_force_n(const Real& w_m) const;
  // Its first (N/m) and second derivative (N/m^2).
  struct LoadingSlopes {
    Real first{}, second{};
  };
  LoadingSlopes loading_slopes(const Real& w_m) const;
  // The next compression above this one at which the loading is not smooth.
  Real next_kink_m(const Real& w_m) const;
  // Compression that stays after a largest one of `largest_m`.
  Real residual_m(const Real& largest_m) const;
  // Why the law should not be used up to there; empty where it may.
  std::string out_of_range(double largest_m) const;
  // Exponent n of the way back: P = P_m ((w - w_r) / (w_m - w_r))^n.
  Real unloading_exponent(const Real& largest_m) const;
  // Force at `w_m` on the way back from (or again towards) `largest_m`. Zero for w_m <= residual.
  Real unloading_force_n(const Real& w_m, const Real& largest_m) const;
  Real unloading_force_n(const Real& w_m, const Real& largest_m, const Real& residual_m) const;
  // Energy put in up to `w_m` (J), integrated to 1e-12 relative, and energy given back from there.
  Real loading_energy_j(const Real& w_m) const;
  Real released_energy_j(const Real& largest_m) const;
  // Largest compression (m) of a mass meeting the flat at `speed_m_s`, without gravity.
  double largest_compression_m(double mass_kg, double speed_m_s) const;
  // sqrt(energy given back / energy put in) of that impact, without gravity.
  double restitution(double mass_kg, double speed_m_s) const;

  const Numbers& surface() const { return surface_; }

 private:
  Real yield_over_modulus() const {
    return surface_.yield_strength_pa / surface_.effective_modulus_pa;
  }
  Real normalised_loading(const Real& x) const;
  Real loading_work(const Real& x) const;
  Real fitted_residual_m(const Real& largest_m) const;

  Numbers surface_;
  PlasticLoading loading_;
  ResidualLaw residual_;
  Real yield_constant_;  // C
  Real critical_compression_m_, critical_force_n_;
};
using ElasticPlasticLaw = ElasticPlasticLawOf<double>;

// Johnson 1985, Eq. 11.47: fully plastic loading at mean pressure p_d = 3 Y, elastic recovery.
//   e^2 = (3 pi^1.25 4^.75 / 10) (p_d/E*) (m V^2 / 2 / (p_d R^3))^(-1/4)
// Holds far beyond yield only; there e < 1.
double johnson_restitution(const ElasticPlasticSurface& surface, double mass_kg, double speed_m_s);

// Thornton 1997 as a function of V_y / V, the speed of first yield over the speed of impact; 1 from
// V_y / V >= 1 on.
//   e = sqrt(6 sqrt3 / 5) sqrt(1 - y^2/6) [ y / (y + 2 sqrt(6/5 - y^2/5)) ]^(1/4)
double thornton_restitution(double yield_speed_over_speed);

}  // namespace impactdic::sim::contact
