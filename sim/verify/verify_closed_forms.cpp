// Rows of `impactdic verify`: formulas against their check values and integrations against
// formulas.
#include <impactdic/units.h>

#include <cmath>

#include "sim/contact/closed_form.h"
#include "sim/contact/impact.h"
#include "sim/job/source_jobs.h"
#include "sim/verify/verify_cases.h"

namespace impactdic::sim::verify {

namespace {

constexpr double kRounding = 1e-12;

ImpactJob weightless(ImpactJob job) {
  job.gravity_m_s2 = 0;
  return job;
}

void add_linear(std::vector<VerifyCase>& cases) {
  const std::string group = "linear spring-damper, no gravity";
  const ImpactJob job = weightless(job::racket_job());
  const double speed = -job.initial.vn_m_s;
  const contact::LinearImpact exact = contact::linear_impact(
      job.body.mass_kg, job.contact.stiffness, job.contact.damping_n_s_per_m, speed);
  const auto row = [&](const char* name, double expected, double (*figure)(const ImpactResult&)) {
    cases.push_back({group, name, "formula: closed form", expected,
                     kIntegrated * std::abs(expected),
                     [job, figure] { return figure(contact::simulate_impact(job)); }});
  };
  row("restitution", exact.restitution, [](const ImpactResult& r) { return r.restitution; });
  row("contact duration, s", exact.contact_s, [](const ImpactResult& r) { return r.contact_s; });
  row("time of maximum compression, s", exact.t_max_compression_s,
      [](const ImpactResult& r) { return r.t_max_compression_s; });
  row("maximum deflection, m", exact.max_deflection_m,
      [](const ImpactResult& r) { return r.max_deflection_m; });
  const double zeta =
      job.contact.damping_n_s_per_m / (2 * std::sqrt(job.contact.stiffness * job.body.mass_kg));
  for (const RestitutionDamping damping :
       {RestitutionDamping::kToZeroForce, RestitutionDamping::kToZeroDeflection}) {
    ImpactJob damped = job;
    damped.contact.restitution_damping = damping;
    cases.push_back({group, "restitution, damped " + std::string(name_of(damping)),
                     "formula: closed form", contact::damped_restitution(zeta, damping),
                     kIntegrated,
                     [damped] { return contact::simulate_impact(damped).restitution; }});
  }
}

// Stiffness and damping back from the restitution and the duration that they give.
void add_linear_inverse(std::vector<VerifyCase>& cases) {
  const std::string group = "linear spring-damper, no gravity";
  const ImpactJob job = weightless(job::racket_job());
  const contact::LinearImpact exact = contact::linear_impact(
      job.body.mass_kg, job.contact.stiffness, job.contact.damping_n_s_per_m, -job.initial.vn_m_s);
  const auto inverse = [job, exact] {
    return contact::linear_parameters(job.body.mass_kg, exact.restitution, exact.contact_s);
  };
  cases.push_back({group, "stiffness from (e, T), N/m", "formula: closed form",
                   job.contact.stiffness, kRounding * job.contact.stiffness * 100,
                   [inverse] { return inverse().stiffness; }});
  cases.push_back({group, "damping from (e, T), N s/m", "formula: closed form",
                   job.contact.damping_n_s_per_m, kRounding * 100,
                   [inverse] { return inverse().damping_n_s_per_m; }});
  cases.push_back(
      {group, "Kelvin-Voigt stiffness, N/m", "formula: Dignall & Haake 2000", 13385.3, 0.5,
       [] { return contact::kelvin_voigt_parameters(0.0567, 0.73559, 6.4967e-3).stiffness; }});
  cases.push_back(
      {group, "Kelvin-Voigt damping, N s/m", "formula: Dignall & Haake 2000", 5.3601, 5e-4, [] {
         return contact::kelvin_voigt_parameters(0.0567, 0.73559, 6.4967e-3).damping_n_s_per_m;
       }});
  ImpactJob force_free = job;
  force_free.contact.restitution_damping = RestitutionDamping::kToZeroForce;
  cases.push_back({group, "stiffness from (e, T) damped to zero force, N/m", "formula: closed form",
                   job.contact.stiffness, 1e-7 * job.contact.stiffness, [force_free] {
                     const ImpactResult r = contact::simulate_impact(force_free);
                     return contact::force_free_parameters(force_free.body.mass_kg, r.restitution,
                                                           r.contact_s)
                         .stiffness;
                   }});
  ImpactJob kelvin_voigt = job;
  kelvin_voigt.contact.restitution_damping = RestitutionDamping::kToZeroDeflection;
  cases.push_back({group, "Kelvin-Voigt stiffness from its own integration, N/m",
                   "formula: Dignall & Haake 2000", job.contact.stiffness,
                   1e-7 * job.contact.stiffness, [kelvin_voigt] {
                     const ImpactResult r = contact::simulate_impact(kelvin_voigt);
                     return contact::kelvin_voigt_parameters(kelvin_voigt.body.mass_kg,
                                                             r.restitution, r.contact_s)
                         .stiffness;
                   }});
}

void add_hertz(std::vector<VerifyCase>& cases) {
  const std::string group = "Hertz, no gravity";
  ImpactJob job = weightless(job::wood_published_job());
  job.friction = FrictionModel::kNone;
  const double mass = job.body.mass_kg, stiffness = job.contact.stiffness;
  const double speed = -job.initial.vn_m_s;
  const double scale = std::pow(mass, 0.6) * std::pow(stiffness, 0.4) * std::pow(speed, 0.2);
  struct Row {
    double damping, restitution;
  };
  for (const Row& row :
       {Row{0.05, 0.95673}, Row{0.1, 0.91616}, Row{0.2, 0.84232}, Row{0.3, 0.77704}}) {
    ImpactJob damped = job;
    damped.contact.damping_n_s_per_m = row.damping * scale;
    cases.push_back({group, "restitution at b/(m^.6 k^.4 v^.2) = " + std::to_string(row.damping),
                     "independent calculation, another integrator", row.restitution, 5e-6,
                     [damped] { return contact::simulate_impact(damped).restitution; }});
  }
  job.contact.damping_n_s_per_m = 0;
  cases.push_back({group, "T (k/m)^.4 v^.2", "formula: Hertz 1882", 3.2180, 1e-4, [=] {
                     return contact::simulate_impact(job).contact_s *
                            std::pow(stiffness / mass, 0.4) * std::pow(speed, 0.2);
                   }});
  cases.push_back({group, "contact duration, s", "formula: Hertz 1882",
                   contact::hertz_contact_s(mass, stiffness, speed),
                   kIntegrated * contact::hertz_contact_s(mass, stiffness, speed),
                   [job] { return contact::simulate_impact(job).contact_s; }});
  cases.push_back({group, "maximum deflection, m", "formula: Hertz 1882",
                   contact::hertz_max_deflection_m(mass, stiffness, speed),
                   kIntegrated * contact::hertz_max_deflection_m(mass, stiffness, speed),
                   [job] { return contact::simulate_impact(job).max_deflection_m; }});
  cases.push_back({group, "T v/delta_m", "formula: Hertz 1882", 2.94328, 5e-6, [=] {
                     return contact::hertz_contact_s(mass, stiffness, speed) * speed /
                            contact::hertz_max_deflection_m(mass, stiffness, speed);
                   }});
  // k = 4/3 E* sqrt(R): T = 2.8683 (m^2/(R E*^2 v))^(1/5).
  cases.push_back({group, "T (R E*^2 v / m^2)^(1/5)", "formula: Hertz 1882", 2.8683, 5e-5, [=] {
                     const double radius = 0.01, modulus = 0.75 * stiffness / std::sqrt(radius);
                     return contact::hertz_contact_s(mass, stiffness, speed) *
                            std::pow(radius * modulus * modulus * speed / (mass * mass), 0.2);
                   }});
  cases.push_back({group, "stiffness from (e, T), N/m^1.5", "formula: inverse", stiffness,
                   1e-7 * stiffness, [=] {
                     ImpactJob damped = job;
                     damped.contact.damping_n_s_per_m = 9.5;
                     const ImpactResult r = contact::simulate_impact(damped);
                     return contact::hertz_parameters(mass, speed, r.restitution, r.contact_s,
                                                      RestitutionDamping::kNone)
                         .stiffness;
                   }});
}

void add_rebounds(std::vector<VerifyCase>& cases) {
  const std::string group = "rebound formulas";
  const ImpactBody solid{BodyShape::kSolidSphere, 0.1, 0.05},
      shell{BodyShape::kHollowSphere, 0.1, 0.05};
  const ImpactVelocities before{1, -2, 0};
  const auto row = [&](const char* name, const char* source, double expected,
                       std::function<double()> compute) {
    cases.push_back({group, name, source, expected, kRounding, std::move(compute)});
  };
  row("solid superball: vt'/vt", "formula: Garwin 1969", 3.0 / 7,
      [=] { return contact::garwin_rebound(solid, before).vt_m_s; });
  row("solid superball: R omega'/vt", "formula: Garwin 1969", -10.0 / 7,
      [=] { return contact::garwin_rebound(solid, before).omega_rad_s * solid.radius_m(); });
  row("solid ball rolls: vt'/vt", "formula: Brody 1984", 5.0 / 7,
      [=] { return contact::brody_rebound(solid, before, 0.8, 1).vt_m_s; });
  row("shell rolls: vt'/vt", "formula: Brody 1984", 3.0 / 5,
      [=] { return contact::brody_rebound(shell, before, 0.8, 1).vt_m_s; });
  row("sliding: vt' - vt", "formula: Brody 1984", -0.05 * 1.8 * 2,
      [=] { return contact::brody_rebound(solid, before, 0.8, 0.05).vt_m_s - 1; });
  row("e_x = 0 rolls", "formula: Cross 2002", 5.0 / 7,
      [=] { return contact::cross_rebound(solid, before, 0.8, 0).vt_m_s; });
  row("e_x = 0.5: vt'/vt", "formula: Cross 2002", (1 - 0.4 * 0.5) / 1.4,
      [=] { return contact::cross_rebound(solid, before, 0.8, 0.5).vt_m_s; });
  row("gross slip: change of spin, rad/s", "formula: Walton 1993", -2.5 * 0.1 * 1.8 * 2 / 0.025,
      [=] { return contact::walton_rebound(solid, before, 0.8, 0.1, 0.5).omega_rad_s; });
  row("ball: energetic equals Newton's restitution", "formula: Stronge 1990", 0.8 * 2,
      [=] { return contact::stronge_rebound(solid, 0, -0.025, before, 0.8, 0.1).vn_m_s; });
  row("ball that slides: as Brody", "formula: Stronge 1990",
      contact::brody_rebound(solid, before, 0.8, 0.05).vt_m_s,
      [=] { return contact::stronge_rebound(solid, 0, -0.025, before, 0.8, 0.05).vt_m_s; });
  row("ball that stops sliding: as Brody", "formula: Stronge 1990",
      contact::brody_rebound(solid, before, 0.8, 1).vt_m_s,
      [=] { return contact::stronge_rebound(solid, 0, -0.025, before, 0.8, 1).vt_m_s; });
}

// The rebound psi of the integration for an elastic solid sphere, nu 0.3.
double integrated_psi(double psi) {
  ImpactJob job = weightless(job::wood_sound_job());
  job.contact.damping_n_s_per_m = 0;
  job.contact.poisson = 0.3;
  const double friction = job.contact.friction_kinetic;
  job.initial.vn_m_s = -1;
  job.initial.vt_m_s = psi / contact::maw_psi(0.3, friction, 1, 1);
  return contact::maw_psi(0.3, friction, contact::simulate_impact(job).tip_vt_final_m_s, 1);
}

void add_partial_slip(std::vector<VerifyCase>& cases) {
  const std::string group = "elastic sphere, partial slip";
  cases.push_back({group, "chi, solid sphere, nu 0.3", "formula: Maw, Barber & Fawcett 1976",
                   1.44118, 5e-6, [] { return contact::maw_chi(0.3, 0.4); }});
  struct Row {
    double psi, rebound;
  };
  // The last digits are those of a run with discrete springs.
  for (const Row& row :
       {Row{0.5, 0.0479}, Row{1, -0.0597}, Row{1.5, -0.4280}, Row{3, -1.3797}, Row{6, 0.2353}}) {
    cases.push_back({group, "rebound at psi = " + std::to_string(row.psi),
                     "independent calculation, discrete springs", row.rebound, 1e-4,
                     [row] { return integrated_psi(row.psi); }});
  }
  cases.push_back({group, "gross slip: psi - 4 chi", "formula: Maw, Barber & Fawcett 1976",
                   6 - 4 * contact::maw_chi(0.3, 0.4), 1e-8, [] { return integrated_psi(6); }});
}

}  // namespace

std::vector<VerifyCase> closed_form_cases() {
  std::vector<VerifyCase> cases;
  add_linear(cases);
  add_linear_inverse(cases);
  add_hertz(cases);
  add_rebounds(cases);
  add_partial_slip(cases);
  return cases;
}

}  // namespace impactdic::sim::verify
