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

struct Solid {
  const char* name;
  ElasticMaterial elastic;
  double density_kg_m3;
};

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
  for (const Solid& m :
       {Solid{"glass", {48e9, 0.2}, 2800}, Solid{"limestone", {20e9, 0.25}, 2500}}) {
    ImpactJob job = elastic(0.01, m.density_kg_m3, 10);
    job.other = OtherBody{job.body, {}};
    job.other->initial.vn_m_s = 10;
    job.take_materials({m.elastic, m.elastic});
    add_hertz(cases, std::string("test 1, two spheres of ") + m.name, job);
  }
  for (const Solid& m : {Solid{"aluminium alloy", {70e9, 0.3}, 2699},
                         Solid{"magnesium alloy", {40e9, 0.35}, 1800}}) {
    ImpactJob job = elastic(0.1, m.density_kg_m3, 0.2);
    job.take_materials({m.elastic, wall_of(m.elastic)});
    add_hertz(cases, std::string("test 2, a sphere of ") + m.name + " on a wall", job);
  }
  for (const Solid& m :
       {Solid{"alumina", {380e9, 0.23}, 4000}, Solid{"cast iron", {100e9, 0.25}, 7000}}) {
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

constexpr Solid kAluminiumAlloy{"aluminium alloy", {70e9, 0.33}, 2700};
constexpr Solid kNylon{"nylon", {2.5e9, 0.4}, 1000};
constexpr Solid kCopper{"copper", {120e9, 0.35}, 8900};

// A ball with friction that meets its own material.
ImpactJob rough(double radius_m, const Solid& solid, double speed_m_s, double friction,
                double restitution) {
  ImpactJob job = elastic(radius_m, solid.density_kg_m3, speed_m_s);
  job.normal = NormalModel::kTsuji;
  job.friction = FrictionModel::kMawBarberFawcett;
  job.contact.friction_kinetic = friction;
  job.contact.restitution_damping = RestitutionDamping::kToZeroForce;
  job.take_materials({solid.elastic, solid.elastic, restitution, 0});
  return job;
}

void add_row(std::vector<VerifyCase>& cases, const std::string& name, const char* source,
             double expected, double tolerance, const ImpactJob& job,
             double (*figure)(const ImpactResult&)) {
  cases.push_back({"Chung & Ooi 2011", name, source, expected, tolerance,
                   [job, figure] { return figure(contact::simulate_impact(job)); }});
}

double recoil(const ImpactResult& r) { return r.tip_vt_final_m_s / r.final.vn_m_s; }

// Test 5: one speed out of the surface, many along it. What slides throughout follows the balance
// of momentum alone: V_t'/(mu V_n') = V_t/(mu V_n) - 7, R omega'/(mu V_n) = -5.
void add_sliding(std::vector<VerifyCase>& cases) {
  constexpr double kSpeed = 5, kFriction = 0.3, kRadius = 1e-5;
  for (const Solid& solid :
       {Solid{"steel", {208e9, 0.3}, 7850}, Solid{"polyethylene", {1e9, 0.4}, 1400}}) {
    for (const double incidence : {8.0, 14.0, 20.0}) {
      ImpactJob job = rough(kRadius, solid, kSpeed, kFriction, 1);
      job.initial.vt_m_s = incidence * kFriction * kSpeed;
      char name[80];
      std::snprintf(name, sizeof name, "test 5, %s, V_t/(mu V_n) %g: ", solid.name, incidence);
      add_row(cases, std::string(name) + "V_t'/(mu V_n')", "formula: balance of momentum",
              incidence - 7, 1e-8, job,
              [](const ImpactResult& r) { return recoil(r) / kFriction; });
      add_row(cases, std::string(name) + "R omega'/(mu V_n)", "formula: balance of momentum", -5,
              1e-8, job, [](const ImpactResult& r) {
                return kRadius * r.final.omega_rad_s / (kFriction * kSpeed);
              });
    }
  }
  // Between, in the variables of Maw, Barber and Fawcett.
  const Solid steel{"steel", {208e9, 0.3}, 7850};
  ImpactJob job = rough(kRadius, steel, kSpeed, kFriction, 1);
  job.initial.vt_m_s = 3 * kSpeed / contact::maw_psi(0.3, kFriction, 1, 1);
  add_row(cases, "test 5, steel, psi 3: psi after", "independent calculation: discrete springs",
          -1.3797, 1e-4, job,
          [](const ImpactResult& r) { return contact::maw_psi(0.3, kFriction, recoil(r), 1); });
}

// Tests 6 and 8: a spinning ball on a plane, and on a far heavier ball that rests. Where it slides
// throughout V_t'/V_n' = (V_t/V_n - 7/2 mu (1 + e))/e.
void add_spinning(std::vector<VerifyCase>& cases) {
  constexpr double kSpeed = 0.2, kFriction = 0.4, kRestitution = 0.5, kRadius = 0.1;
  const double slows = 3.5 * kFriction * (1 + kRestitution);
  for (const Solid& solid : {kAluminiumAlloy, kNylon}) {
    for (const double ratio : {4.0, 8.0}) {
      ImpactJob plane = rough(kRadius, solid, kSpeed, kFriction, kRestitution);
      plane.initial.omega_rad_s = ratio * kSpeed / kRadius;
      ImpactJob heavy = plane;
      heavy.other = OtherBody{sphere(5 * kRadius, 1000 * solid.density_kg_m3), {}};
      heavy.take_materials({solid.elastic, solid.elastic, kRestitution, 0});
      char name[80];
      std::snprintf(name, sizeof name, ", %s, V_t/V_n %g: V_t'/V_n'", solid.name, ratio);
      add_row(cases, std::string("test 6") + name, "formula: balance of momentum",
              (ratio - slows) / kRestitution, 1e-7, plane, recoil);
      add_row(cases, std::string("test 8") + name, "formula: balance of momentum",
              (ratio - slows) / kRestitution, 1e-7, heavy, [](const ImpactResult& r) {
                return r.tip_vt_final_m_s / (r.final.vn_m_s - r.other_final.vn_m_s);
              });
    }
  }
}

// Test 7: two balls alike that spin against each other do not slip, and keep their spins.
void add_counterspin(std::vector<VerifyCase>& cases) {
  for (const Solid& solid : {kAluminiumAlloy, kCopper}) {
    for (const double spin : {5.0, 22.0}) {
      ImpactJob job = rough(0.1, solid, 0.2, 0.4, 0.5);
      job.initial.omega_rad_s = spin;
      job.other = OtherBody{job.body, {}};
      job.other->initial.vn_m_s = 0.2;
      job.other->initial.omega_rad_s = -spin;
      job.take_materials({solid.elastic, solid.elastic, 0.5, 0});
      char name[80];
      std::snprintf(name, sizeof name, "test 7, %s, %g rad/s: ", solid.name, spin);
      add_row(cases, std::string(name) + "spin after", "formula: nothing slips", spin, 1e-12, job,
              [](const ImpactResult& r) { return r.final.omega_rad_s; });
      add_row(cases, std::string(name) + "V_t after", "formula: nothing slips", 0, 1e-12, job,
              [](const ImpactResult& r) { return r.final.vt_m_s; });
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
  add_sliding(cases);
  add_spinning(cases);
  add_counterspin(cases);
  add_alumina(cases);
  return cases;
}

}  // namespace impactdic::sim::verify
