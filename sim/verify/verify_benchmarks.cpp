// Rows of `impactdic verify`: the impacts of single spheres by which codes of granular matter are
// compared (Chung and Ooi 2011), and the measurements behind one of them.
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sim/contact/closed_form.h"
#include "sim/contact/impact.h"
#include "sim/job/source_jobs.h"
#include "sim/verify/verify_cases.h"

namespace impactdic::sim::verify {

namespace {

// Chung and Ooi ask for 0.01 %; an integration is far nearer.
constexpr double kIntegrated = 1e-9;

ImpactBody sphere(double radius_m, double density_kg_m3) {
  const double mass = density_kg_m3 * 4 * kPi / 3 * radius_m * radius_m * radius_m;
  return {BodyShape::kSolidSphere, mass, 2 * radius_m};
}

// The walls of these tests: a thousand times as stiff.
ElasticMaterial wall_of(const ElasticMaterial& material) {
  return {1000 * material.young_pa, material.poisson};
}

ImpactJob elastic(double radius_m, double density_kg_m3, double speed_m_s) {
  ImpactJob job;
  job.normal = NormalModel::kHertzDamper;
  job.friction = FrictionModel::kNone;
  job.body = sphere(radius_m, density_kg_m3);
  job.gravity_m_s2 = 0;
  job.initial.vn_m_s = -speed_m_s;
  return job;
}

// Force, depth and duration of Hertz (1882) in an elastic impact.
void add_hertz(std::vector<VerifyCase>& cases, const std::string& name, const ImpactJob& job) {
  const double mass = job.contact_mass_kg(), k = job.contact.stiffness;
  const double speed = -job.initial.vn_m_s + (job.other ? job.other->initial.vn_m_s : 0.0);
  const double depth = contact::hertz_max_deflection_m(mass, k, speed);
  const auto row = [&](const char* what, double expected, double (*figure)(const ImpactResult&)) {
    cases.push_back({"Chung & Ooi 2011", name + ": " + what, "formula: Hertz 1882", expected,
                     kIntegrated * expected,
                     [job, figure] { return figure(contact::simulate_impact(job)); }});
  };
  row("largest force, N", k * depth * std::sqrt(depth),
      [](const ImpactResult& r) { return r.max_force_n; });
  row("largest overlap, m", depth, [](const ImpactResult& r) { return r.max_deflection_m; });
  row("duration, s", contact::hertz_contact_s(mass, k, speed),
      [](const ImpactResult& r) { return r.contact_s; });
}

void add_elastic(std::vector<VerifyCase>& cases) {
  struct Material {
    const char* name;
    ElasticMaterial elastic;
    double density_kg_m3;
  };
  for (const Material& m :
       {Material{"glass", {48e9, 0.2}, 2800}, Material{"limestone", {20e9, 0.25}, 2500}}) {
    ImpactJob job = elastic(0.01, m.density_kg_m3, 10);
    job.other = OtherBody{job.body, {}};
    job.other->initial.vn_m_s = 10;
    job.take_materials({m.elastic, m.elastic});
    add_hertz(cases, std::string("test 1, two spheres of ") + m.name, job);
  }
  for (const Material& m : {Material{"aluminium alloy", {70e9, 0.3}, 2699},
                            Material{"magnesium alloy", {40e9, 0.35}, 1800}}) {
    ImpactJob job = elastic(0.1, m.density_kg_m3, 0.2);
    job.take_materials({m.elastic, wall_of(m.elastic)});
    add_hertz(cases, std::string("test 2, a sphere of ") + m.name + " on a wall", job);
  }
  for (const Material& m :
       {Material{"alumina", {380e9, 0.23}, 4000}, Material{"cast iron", {100e9, 0.25}, 7000}}) {
    for (const double restitution : {0.2, 0.4, 0.6, 0.8, 1.0}) {
      ImpactJob job = elastic(0.0025, m.density_kg_m3, 3.9);
      job.normal = NormalModel::kTsuji;
      job.contact.restitution_damping = RestitutionDamping::kToZeroForce;
      job.take_materials({m.elastic, wall_of(m.elastic), restitution, 0});
      char name[80];
      std::snprintf(name, sizeof name, "test 3, %s, restitution %.1f", m.name, restitution);
      cases.push_back({"Chung & Ooi 2011", name, "formula: definition of the restitution",
                       restitution, kIntegrated,
                       [job] { return contact::simulate_impact(job).restitution; }});
    }
  }
}

struct Reading {
  double incidence_deg, value;
};

// Tangential restitution v_t'/v_t and spin after (rad/s), read off the paper's figures by the
// authors of Lethe's example of this impact.
constexpr Reading kTangential[] = {{1.84, 0.79344},   {3.703, 0.74533},  {9.496, 0.67257},
                                   {20.012, 0.59691}, {30.127, 0.68756}, {39.382, 0.77148},
                                   {49.694, 0.84761}, {60.02, 0.90142}};
constexpr Reading kSpin[] = {{6.143, 136.18},  {10.991, 265.69}, {21.251, 577.65}, {31.157, 612.88},
                             {39.143, 595.49}, {50.348, 453.21}, {60.328, 382.09}};
constexpr Reading kRebound[] = {{0.016, 0.074},   {2.15, 1.733},    {4.096, 2.962},
                                {9.826, 6.518},   {20.567, 12.208}, {30.29, 21.67},
                                {39.535, 32.613}, {49.747, 45.125}, {60.208, 57.474}};

template <std::size_t N>
double rms(const Reading (&readings)[N], double unit, double (*figure)(const ImpactResult&)) {
  double sum = 0;
  for (const Reading& reading : readings) {
    const ImpactResult r = contact::simulate_impact(job::alumina_job(reading.incidence_deg));
    sum += std::pow((figure(r) - reading.value) / unit, 2);
  }
  return std::sqrt(sum / N);
}

// Test 4 is this experiment. Nothing is fitted.
void add_alumina(std::vector<VerifyCase>& cases) {
  const std::string group = "alumina on glass, 3.9 m/s, 24 points";
  const char* source = "digitised, Kharaz, Gorham & Salman 2001";
  cases.push_back({group, "tangential restitution, rms", source, 0, 0.03, [] {
                     return rms(kTangential, 1, [](const ImpactResult& r) {
                       return r.final.vt_m_s / r.start.vt_m_s;
                     });
                   }});
  cases.push_back({group, "spin, rms over the largest spin", source, 0, 0.04, [] {
                     double largest = 0;
                     for (const Reading& spin : kSpin) largest = std::max(largest, spin.value);
                     return rms(kSpin, largest,
                                [](const ImpactResult& r) { return -r.final.omega_rad_s; });
                   }});
  cases.push_back({group, "rebound angle, rms, deg", source, 0, 0.5, [] {
                     return rms(kRebound, 1, [](const ImpactResult& r) {
                       return std::atan2(r.final.vt_m_s, r.final.vn_m_s) * kDegPerRad;
                     });
                   }});
}

}  // namespace

std::vector<VerifyCase> benchmark_cases() {
  std::vector<VerifyCase> cases;
  add_elastic(cases);
  add_alumina(cases);
  return cases;
}

}  // namespace impactdic::sim::verify
