// Oblique impact of a round-ended rod on a flat (dissertation, chapter 5), rigid or flexible.
//
// The rod leans at `angle_rad` from the flat; its lower tip, a sphere of the rod's radius, meets
// the flat. Axes: x along the flat towards the rod's upper end, y out of the flat, rotation
// counter-clockwise. Eqs. 5.1-5.7 with the weight along -y (Eq. 5.6 prints it along x). A flexible
// rod adds the free-free axial and bending modes of a uniform Euler-Bernoulli beam: its tip lives
// on vibration, meets the flat again and again (micro-impacts), and the rebound no longer depends
// on the speed the way plasticity alone would have it.
#pragma once

#include <impactdic/export.h>
#include <impactdic/impact_model.h>

#include <string>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// The two bodies in contact. `yield_strength_pa` is that of the weaker one.
struct ElasticPlasticSurface {
  double radius_m = 0;              // of the tip; of curvature, sum of 1/R if both are curved
  double effective_modulus_pa = 0;  // E*: 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2
  double yield_strength_pa = 0;
  double poisson = 0;  // of the weaker body

  // Throws InvalidArgument naming the key of the first impossible value.
  void validate() const;
};

enum class PlasticLoading { kJacksonGreen, kKogutEtsion, kThornton, kStronge };

struct RodBody {
  double length_m = 0.3048;
  double radius_m = 0.0088;  // of the cross-section and of the round end
  double mass_kg = 0.5784;
  double young_pa = 200e9;  // of the rod; sets its modes

  // m L^2 / 12, the inertia chapter 5 uses.
  double inertia_kg_m2() const { return mass_kg * length_m * length_m / 12; }
};

struct RodJob {
  RodBody body;
  ElasticPlasticSurface surface{0.0088, 109.1823e9, 300e6, 0.29};
  PlasticLoading loading = PlasticLoading::kJacksonGreen;
  ResidualLaw residual = ResidualLaw::kKogutEtsion;
  double friction_kinetic = 0.13;  // Coulomb; sticks while the flat can hold the tip
  int axial_modes = 10;            // 0 and 0: the rigid rod
  int bending_modes = 12;
  double modal_damping = 0.002;  // fraction of critical, the same in every mode
  double angle_rad = 0;
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;  // of the centre of mass at the first touch
  double gravity_m_s2 = 9.81;
  double relative_tolerance = 1e-9;
  double longest_s = 0.05;    // the blow is given up after this, or 20 contacts, if that is longer
  double sample_rate_hz = 0;  // of the trajectory; 0: none is kept

  // Throws InvalidArgument naming the key of the first impossible value.
  void validate() const;
};

// The source's rigid rod with Jackson's residual, and the flexible one.
RodJob rigid_rod_preset();
RodJob flexible_rod_preset();

// A rod's job with what a job file says of it by words.
struct RodModel {
  bool flexible = false;
  // Chooses the residual where a job file names none: kPublished Jackson's, kSound Kogut and
  // Etsion's.
  ModelPreset preset = ModelPreset::kPublished;
  RodJob rod;
};

struct RodPhase {
  std::string name;  // loading, unloading, reloading, free; slip_forward, slip_backward, stick
  double start_s = 0, end_s = 0;
};

struct RodSample {
  double time_s = 0;
  double x_m = 0, y_m = 0, angle_rad = 0;  // centre of mass; y above the flat
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;
  double normal_force_n = 0, tangential_force_n = 0;
  double compression_m = 0;               // of the contact; negative: a gap
  double tip_vt_m_s = 0, tip_vn_m_s = 0;  // of the contact point, vibration included
};

// Every term in joule. `residual_j` is what the terms fail to explain.
struct RodEnergy {
  double kinetic_before_j = 0, kinetic_after_j = 0, vibration_after_j = 0;
  double plastic_j = 0, friction_j = 0, damping_j = 0;  // lost
  double gravity_j = 0;                                 // gained
  double residual_j = 0;
};

struct RodImpact {
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;  // rigid motion after the blow
  // Rigid normal velocity of the contact point after over before, sign turned (section 5.3).
  double restitution = 0;
  double tip_vn_before_m_s = 0, tip_vn_after_m_s = 0, tip_vt_after_m_s = 0;
  double start_to_end_s = 0;  // from the first touch to the last separation
  double contact_s = 0;       // sum of the micro-impacts
  int micro_impacts = 0;
  double max_compression_m = 0, residual_m = 0, max_force_n = 0;
  double normal_impulse_n_s = 0, tangential_impulse_n_s = 0;
  RodEnergy energy;
  std::vector<RodPhase> normal_phases, friction_phases;
  std::vector<RodSample> trajectory;
  std::vector<std::string> warnings;
};

}  // namespace impactdic
