#include "sim/verify/verify_rod.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "sim/contact/law/normal_elastoplastic.h"
#include "sim/rod/rod_impact.h"
#include "sim/rod/rod_motion.h"

namespace impactdic::sim::verify {
namespace {

constexpr double kHalfLastDigit = 0.5;

RodJob struck(RodJob job, double angle_deg) {
  job.angle_rad = angle_deg * kRadPerDeg;
  job.vn_m_s = -2.487;
  return job;
}

void add_contact_cases(std::vector<VerifyCase>& cases) {
  const auto law = [](PlasticLoading loading) {
    return contact::ElasticPlasticLaw(RodJob{}.surface, loading, ResidualLaw::kKogutEtsion);
  };
  const std::string group = "elastic-plastic contact";
  cases.push_back({group, "critical compression, m", "formula: Jackson & Green 2005", 4.213e-7,
                   kHalfLastDigit * 1e-10,
                   [=] { return law(PlasticLoading::kJacksonGreen).critical_compression_m(); }});
  cases.push_back({group, "critical force, N", "formula: Jackson & Green 2005", 3.7344,
                   kHalfLastDigit * 1e-4,
                   [=] { return law(PlasticLoading::kJacksonGreen).critical_force_n(); }});
  cases.push_back({group, "Thornton's restitution at twice the yield speed",
                   "formula: Thornton 1997", 0.930626, kHalfLastDigit * 1e-6,
                   [] { return contact::thornton_restitution(0.5); }});
  cases.push_back({group, "the same from the law's two energies", "conservation",
                   contact::thornton_restitution(0.5), 1e-10, [=] {
                     const contact::ElasticPlasticLaw thornton = law(PlasticLoading::kThornton);
                     const double mass = 0.5784;
                     const double yield_energy =
                         0.4 * thornton.critical_force_n() * thornton.critical_compression_m();
                     return thornton.restitution(mass, 2 * std::sqrt(2 * yield_energy / mass));
                   }});
  cases.push_back({group, "Johnson's restitution, ratio at 16 times the speed",
                   "formula: Johnson 1985", 0.5, 1e-12, [] {
                     const ElasticPlasticSurface surface = RodJob{}.surface;
                     return contact::johnson_restitution(surface, 1, 16) /
                            contact::johnson_restitution(surface, 1, 1);
                   }});
  const auto jump = [=](double x) {
    const contact::ElasticPlasticLaw kogut = law(PlasticLoading::kKogutEtsion);
    const double w = x * kogut.critical_compression_m();
    return kogut.loading_force_n(w * (1 + 1e-10)) / kogut.loading_force_n(w * (1 - 1e-10)) - 1;
  };
  cases.push_back({group, "jump of the Kogut-Etsion fit at x = 1", "formula: Kogut & Etsion 2002",
                   0.03, 1e-8, [=] { return jump(1); }});
  cases.push_back({group, "jump of the Kogut-Etsion fit at x = 6", "formula: Kogut & Etsion 2002",
                   0.017, kHalfLastDigit * 1e-3, [=] { return jump(6); }});
}

// The largest difference of a phase's limit from a run at 1e-13, s; NaN where the phases differ.
double switch_error_s(RodJob job, double tolerance) {
  job.relative_tolerance = tolerance;
  const RodImpact run = rod::simulate_rod(job);
  job.relative_tolerance = 1e-13;
  const RodImpact exact = rod::simulate_rod(job);
  double largest = 0;
  for (const auto phases : {&RodImpact::normal_phases, &RodImpact::friction_phases}) {
    if ((run.*phases).size() != (exact.*phases).size()) return kNotMeasured;
    for (std::size_t i = 0; i < (run.*phases).size(); ++i) {
      const RodPhase &a = (run.*phases)[i], &b = (exact.*phases)[i];
      largest = std::max({largest, std::abs(a.start_s - b.start_s), std::abs(a.end_s - b.end_s)});
    }
  }
  return largest;
}

void add_rod_cases(std::vector<VerifyCase>& cases) {
  // Measured (section 5.3): restitution 0.55, 0.44, 0.08; neither rod gives all of them.
  struct Row {
    bool flexible;
    double angle_deg, restitution, omega_rad_s;
  };
  for (const Row& row :
       {Row{false, 17, .290, -15.9}, Row{false, 45, .270, -16.5}, Row{false, 70, .242, -10.6},
        Row{true, 17, .647, -20.3}, Row{true, 45, .597, -20.8}, Row{true, 70, .142, -9.8}}) {
    const auto impact = [row] {
      return rod::simulate_rod(
          struck(row.flexible ? flexible_rod_preset() : rigid_rod_preset(), row.angle_deg));
    };
    const std::string group = row.flexible ? "flexible rod" : "rigid rod";
    const std::string at = std::to_string(static_cast<int>(row.angle_deg)) + " deg, 2.487 m/s";
    cases.push_back({group, "restitution at " + at, "independent calculation, another integrator",
                     row.restitution, kHalfLastDigit * 1.02e-3,
                     [=] { return impact().restitution; }});
    cases.push_back({group, "omega after, rad/s, at " + at,
                     "independent calculation, another integrator", row.omega_rad_s,
                     kHalfLastDigit * 1.02e-1, [=] { return impact().omega_rad_s; }});
    cases.push_back({group, "energy left unexplained at " + at, "conservation", 0, 1e-9, [=] {
                       const RodEnergy energy = impact().energy;
                       return energy.residual_j / energy.kinetic_before_j;
                     }});
    const RodJob job =
        struck(row.flexible ? flexible_rod_preset() : rigid_rod_preset(), row.angle_deg);
    cases.push_back({group, "switch times, default tolerance, s, at " + at,
                     "regression, against rtol 1e-13", 0, 1e-10,
                     [=] { return switch_error_s(job, job.relative_tolerance); }});
    cases.push_back({group, "switch times, rtol 1e-10, s, at " + at,
                     "regression, against rtol 1e-13", 0, 1e-12,
                     [=] { return switch_error_s(job, 1e-10); }});
  }
}

void add_closure_cases(std::vector<VerifyCase>& cases) {
  const auto closure = [] {
    RodSide before, after;
    before.vt_m_s.value = 0.067, before.vn_m_s.value = -2.487, before.omega_rad_s.value = 0.02;
    after.vt_m_s.value = -0.14, after.vn_m_s.value = -0.855, after.omega_rad_s.value = -19.67;
    before.angle_rad.value = after.angle_rad.value = kPi / 4;
    return rod::close_impulses(RodBody{}, 0.13, before, after);
  };
  const std::string group = "impulse closure";
  cases.push_back({group, "45 deg shot, axis as printed, rad/s",
                   "independent calculation, from the velocities of section 5.3", -25.8, 0.05,
                   [=] { return closure().omega_as_measured_rad_s.value; }});
  cases.push_back({group, "45 deg shot, axis flipped, rad/s",
                   "independent calculation, from the velocities of section 5.3", -19.58,
                   kHalfLastDigit * 1e-2,
                   [=] { return closure().omega_axis_flipped_rad_s.value; }});
}

}  // namespace

std::vector<VerifyCase> rod_cases() {
  std::vector<VerifyCase> cases;
  add_contact_cases(cases);
  add_rod_cases(cases);
  add_closure_cases(cases);
  return cases;
}

}  // namespace impactdic::sim::verify
