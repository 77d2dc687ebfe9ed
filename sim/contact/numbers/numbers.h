// The numbers of a job, each with or without derivatives. What is a choice stays in the job.
#pragma once

#include <impactdic/impact_model.h>

#include <string>
#include <vector>

#include "sim/contact/numbers/real.h"

namespace impactdic::sim::contact {

template <typename Real>
struct BodyNumbers {
  BodyShape shape{};
  Real mass_kg{}, diameter_m{}, length_m{};
  Real given_inertia_kg_m2{};  // 0: that of the shape

  Real radius_m() const { return diameter_m / 2.0; }
  Real inertia() const;
};

template <typename Real>
struct MotionNumbers {
  Real vt_m_s{}, vn_m_s{}, vb_m_s{};
  Real omega_rad_s{}, omega_t_rad_s{}, omega_n_rad_s{};
  Real gap_m{}, angle_deg{};
};

// As in ContactParameters.
template <typename Real>
struct ContactNumbers {
  Real stiffness{}, damping_n_s_per_m{}, damping_factor{}, dissipation_s{}, damping_s_per_m{};
  Real friction_kinetic{}, friction_static{}, friction_speed_m_s{};
  Real poisson{}, reduced_modulus_pa{}, yield_strength_pa{}, adhesion_j_per_m2{};
  Real unloading_stiffness_n_per_m{}, unloading_hardening_per_m{};
  Real tangential_stiffness_n_per_m{};
  Real rolling_friction{}, spinning_friction{};
};

// As in BallShell.
template <typename Real>
struct ShellNumbers {
  Real stiffness_n_per_m{}, damping_n_s_per_m{}, flat_fraction{};
};

template <typename Real>
struct JobNumbers {
  JobNumbers() = default;
  explicit JobNumbers(const ImpactJob& job);

  Real contact_radius_m() const;
  Real contact_mass_kg() const;
  Real gravity_t() const;
  Real gravity_n() const;
  // Of the one body that stands for two balls (two_bodies.h).
  JobNumbers relative() const;

  BodyNumbers<Real> body, other;
  MotionNumbers<Real> initial, other_initial;
  ContactNumbers<Real> contact;
  bool two_balls = false;
  bool has_shell = false;
  ShellNumbers<Real> shell;
  Real surface_angle_deg{}, surface_radius_m{}, gravity_m_s2{};
  Real air_density_kg_m3{}, drag_coefficient{}, lift_coefficient{};
};

// One number that a job's outcome depends on.
template <typename Real>
struct NumberOfJob {
  std::string key;  // as in a job file, "contact.stiffness_n_per_m"
  Real* number = nullptr;
  double scale = 0;  // a change that matters; above zero
};
// All of them, in the order of a job file: those that the job's laws read.
template <typename Real>
std::vector<NumberOfJob<Real>> numbers_of(const ImpactJob& job, JobNumbers<Real>& numbers);

}  // namespace impactdic::sim::contact
