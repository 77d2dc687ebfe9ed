// Rows of `impactdic verify`: normal laws with a closed form, integrated against it.
#include <impactdic/units.h>

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "sim/contact/closed_form.h"
#include "sim/contact/impact.h"
#include "sim/contact/law/normal_elastoplastic.h"
#include "sim/job/source_jobs.h"
#include "sim/verify/verify_cases.h"

namespace impactdic::sim::verify {

namespace {

// A lacrosse ball that falls straight on the surface, without weight.
ImpactJob straight(NormalModel normal) {
  ImpactJob job = job::wood_published_job();
  job.gravity_m_s2 = 0;
  job.normal = normal;
  job.friction = FrictionModel::kNone;
  job.contact.restitution_damping = RestitutionDamping::kToZeroForce;
  return job;
}

double depth(const ImpactResult& r) { return r.max_deflection_m; }

// A restitution is as exact as the speed before; other figures are held to a part of themselves.
void add(std::vector<VerifyCase>& cases, const std::string& name, const char* source,
         double expected, const ImpactJob& job, double (*figure)(const ImpactResult&),
         double tolerance = kIntegrated) {
  const double unit = figure == restitution ? 1 : std::abs(expected);
  cases.push_back({"normal laws, no gravity", name, source, expected, tolerance * unit,
                   [job, figure] { return figure(contact::simulate_impact(job)); }});
}

// With y = d^(5/4) and d(tau) = d^(1/4) dt the law is a linear spring and damper, zeta =
// alpha/sqrt 5.
void add_tsuji(std::vector<VerifyCase>& cases) {
  const char* source = "formula: Antypov & Elliott 2011";
  for (const double zeta : {0.05, 0.3, 0.8}) {
    for (const RestitutionDamping damping :
         {RestitutionDamping::kToZeroForce, RestitutionDamping::kToZeroDeflection}) {
      ImpactJob job = straight(NormalModel::kTsuji);
      job.contact.damping_factor = std::sqrt(5) * zeta;
      job.contact.restitution_damping = damping;
      const std::string what =
          ", zeta " + std::to_string(zeta).substr(0, 4) + ", " + std::string(name_of(damping));
      add(cases, "tsuji: restitution" + what, source, contact::damped_restitution(zeta, damping),
          job, restitution);
      if (damping == RestitutionDamping::kToZeroDeflection) continue;
      const double omega = std::sqrt(1.25 * job.contact.stiffness / job.body.mass_kg);
      const double angle = zeta * std::acos(zeta) / std::sqrt(1 - zeta * zeta);
      const double most = -1.25 * job.initial.vn_m_s / omega * std::exp(-angle);
      add(cases, "tsuji: largest deflection, m" + what, source, std::pow(most, 0.8), job, depth);
    }
  }
}

// e = 1 - C1 b + C2 b^2 - ..., b = 3/2 A (k/m)^0.4 v^0.2, C1 = 1.15344, C2 = 3/5 C1^2.
void add_kuwabara_kono(std::vector<VerifyCase>& cases) {
  for (const double b : {1e-4, 1e-3, 1e-2}) {
    ImpactJob job = straight(NormalModel::kKuwabaraKono);
    const double rate = std::pow(job.contact.stiffness / job.body.mass_kg, 0.4) *
                        std::pow(-job.initial.vn_m_s, 0.2);
    job.contact.dissipation_s = b / (1.5 * rate);
    // What is left out is of the order b^(5/2) (the end at zero force) and 0.48 b^3.
    const double left_out = 0.5 * std::pow(b, 2.5) + 1e-9;
    constexpr double kFirst = 1.1534403;
    char name[80];
    std::snprintf(name, sizeof name, "kuwabara_kono: restitution, 3/2 A (k/m)^0.4 v^0.2 = %g", b);
    add(cases, name, "formula: Schwager & Poeschel 1998, series",
        1 - kFirst * b + 0.6 * kFirst * kFirst * b * b, job, restitution, left_out);
  }
}

// Energy of the rebound at c = 3/2 alpha: c v - ln(1 + c v) = -c u - ln(1 - c u).
double hunt_crossley_restitution(double c, double speed) {
  const double in = c * speed, spent = in - std::log1p(in);
  const auto missing = [=](double out) { return -out - std::log1p(-out) - spent; };
  std::uintmax_t iterations = 200;
  const auto close = [](double a, double b) { return std::abs(b - a) <= 1e-15; };
  const double most = std::min(in * (1 + 1e-12), 1 - 1e-15);
  const auto found = boost::math::tools::toms748_solve(missing, 0.0, most, close, iterations);
  return 0.5 * (found.first + found.second) / in;
}

void add_hunt_crossley(std::vector<VerifyCase>& cases) {
  const char* source = "formula: Hunt & Crossley 1975, integrated";
  for (const double strength : {0.05, 0.3, 1.0, 3.0}) {  // 3/2 alpha v
    ImpactJob job = straight(NormalModel::kHuntCrossley);
    const double speed = -job.initial.vn_m_s;
    job.contact.damping_s_per_m = strength / (1.5 * speed);
    const std::string what = ", 3/2 alpha v = " + std::to_string(strength).substr(0, 4);
    add(cases, "hunt_crossley: restitution" + what, source,
        hunt_crossley_restitution(strength / speed, speed), job, restitution);
    const double spent = (strength - std::log1p(strength)) * speed * speed / strength / strength;
    add(cases, "hunt_crossley: largest deflection, m" + what, source,
        std::pow(2.5 * job.body.mass_kg * spent / job.contact.stiffness, 0.4), job, depth);
  }
}

void add_walton_braun(std::vector<VerifyCase>& cases) {
  const char* source = "formula: Walton & Braun 1986";
  ImpactJob job = straight(NormalModel::kWaltonBraun);
  job.contact.stiffness = 2e5;
  job.contact.unloading_stiffness_n_per_m = 2e5 / (0.7 * 0.7);
  add(cases, "walton_braun: e = sqrt(k1/k2)", source, 0.7, job, restitution);
  const double omega1 = std::sqrt(job.contact.stiffness / job.body.mass_kg);
  add(cases, "walton_braun: duration, pi/2 (1/w1 + 1/w2), s", source, kPi / 2 * 1.7 / omega1, job,
      [](const ImpactResult& r) { return r.contact_s; });
  job.contact.unloading_stiffness_n_per_m = job.contact.stiffness;
  job.contact.unloading_hardening_per_m = 300;
  add(cases, "walton_braun: e = sqrt(w/(w + S v))", source,
      std::sqrt(omega1 / (omega1 - 300 * job.initial.vn_m_s)), job, restitution);
}

// A sphere of 1 mm whose adhesion takes a quarter of its energy.
void add_jkr(std::vector<VerifyCase>& cases) {
  ImpactJob job = straight(NormalModel::kJkr);
  job.body = {BodyShape::kSolidSphere, 4e-6, 2e-3};
  job.contact.reduced_modulus_pa = 1e6;
  job.contact.adhesion_j_per_m2 = 0.1;
  const double w = job.contact.adhesion_j_per_m2, modulus = job.contact.reduced_modulus_pa;
  const double radius = job.body.radius_m();
  const double lost = 7.09 * std::cbrt(std::pow(w, 5) * std::pow(radius, 4) / (modulus * modulus));
  job.initial.vn_m_s = -std::sqrt(2 * lost / (0.25 * job.body.mass_kg));
  // 7.09 is printed with three figures.
  add(cases, "jkr: e^2 = 1 - (v_s/v)^2", "formula: Thornton & Ning 1998", std::sqrt(0.75), job,
      restitution, 2e-4);
  add(
      cases, "jkr: force where the bodies part, N",
      "formula: Johnson, Kendall & Roberts 1971, fixed grips", -5.0 / 6 * kPi * w * radius, job,
      [](const ImpactResult& r) { return r.separation_force_n; }, 1e-6);
  ImpactJob smooth = job;
  smooth.contact.adhesion_j_per_m2 = 0;
  add(cases, "jkr without adhesion: duration of Hertz, s", "formula: Hertz 1882",
      contact::hertz_contact_s(job.body.mass_kg, hertz_stiffness(modulus, radius),
                               -job.initial.vn_m_s),
      smooth, [](const ImpactResult& r) { return r.contact_s; });
}

// What the law's own energies say, integrated.
void add_stronge(std::vector<VerifyCase>& cases) {
  ImpactJob job = straight(NormalModel::kStronge);
  job.body = {BodyShape::kSolidSphere, 0.0327, 0.02};
  job.contact.reduced_modulus_pa = 109e9;
  job.contact.yield_strength_pa = 300e6;
  for (const double speed : {0.05, 0.5}) {
    job.initial.vn_m_s = -speed;
    const contact::ElasticPlasticLaw law({job.body.radius_m(), 109e9, 300e6, 0.3},
                                         PlasticLoading::kStronge, ResidualLaw::kJackson);
    add(cases,
        "stronge_elastoplastic: restitution at " + std::to_string(speed).substr(0, 4) + " m/s",
        "formula: Stronge 2000, energies", law.restitution(job.body.mass_kg, speed), job,
        restitution);
  }
}

// Two masses and two springs, undamped: the sum of two modes, y = b1/w1 sin w1 t + b2/w2 sin w2 t
// of the part in contact and r_i of that of the rest, until y comes back to zero.
struct TwoModes {
  double separation_s = 0, restitution = 0;

  TwoModes(const ImpactJob& job) {
    const double shell = job.shell->stiffness_n_per_m, bed = job.contact.stiffness;
    const double flat = job.shell->flat_fraction * job.body.mass_kg;
    const double rest = job.body.mass_kg - flat, speed = -job.initial.vn_m_s;
    const double half = (shell + bed) / (2 * flat) + shell / (2 * rest);
    const double root = std::sqrt(half * half - shell * bed / (flat * rest));
    const double square[] = {half - root, half + root};
    const double r[] = {shell / (shell - rest * square[0]), shell / (shell - rest * square[1])};
    const double b[] = {speed * (1 - r[1]) / (r[0] - r[1]), speed * (r[0] - 1) / (r[0] - r[1])};
    const double w[] = {std::sqrt(square[0]), std::sqrt(square[1])};
    const auto depth = [&](double t) {
      return b[0] / w[0] * std::sin(w[0] * t) + b[1] / w[1] * std::sin(w[1] * t);
    };
    double t = 1e-3 / w[1];
    while (depth(t) > 0) t += 1e-2 / w[1];
    std::uintmax_t most = 200;
    const auto [low, high] = boost::math::tools::toms748_solve(
        depth, t - 1e-2 / w[1], t, boost::math::tools::eps_tolerance<double>(50), most);
    separation_s = (low + high) / 2;
    for (int i = 0; i < 2; ++i) {
      restitution -=
          b[i] * std::cos(w[i] * separation_s) * (rest * r[i] + flat) / (job.body.mass_kg * speed);
    }
  }
};

// A tennis ball on a string bed.
ImpactJob on_strings(double flat_fraction) {
  ImpactJob job = straight(NormalModel::kLinearSpringDamper);
  job.preset = ModelPreset::kSound;
  job.body = {BodyShape::kHollowSphere, 0.0567, 0.067};
  job.contact = {};
  job.contact.stiffness = 35000;
  job.shell = BallShell{25000, 0, flat_fraction};
  job.initial.vn_m_s = -10;
  return job;
}

void add_shell(std::vector<VerifyCase>& cases) {
  const char* source = "formula: two normal modes";
  for (const double flat : {0.02, 0.2}) {
    const ImpactJob job = on_strings(flat);
    const TwoModes modes(job);
    const std::string what = ", flat fraction " + std::to_string(flat).substr(0, 4);
    add(cases, "shell on a string bed: restitution" + what, source, modes.restitution, job,
        restitution);
    add(cases, "shell on a string bed: duration, s" + what, source, modes.separation_s, job,
        [](const ImpactResult& r) { return r.contact_s; });
  }
  // A shell whose flat part weighs next to nothing is one spring, of both in series.
  const ImpactJob job = on_strings(1e-4);
  const double both = 1 / (1 / 35000.0 + 1 / 25000.0);
  add(
      cases, "shell with a light flat part: duration of the springs in series, s", "limit",
      kPi * std::sqrt(job.body.mass_kg / both), job,
      [](const ImpactResult& r) { return r.contact_s; }, 1e-3);
}

}  // namespace

std::vector<VerifyCase> law_cases() {
  std::vector<VerifyCase> cases;
  add_tsuji(cases);
  add_kuwabara_kono(cases);
  add_hunt_crossley(cases);
  add_walton_braun(cases);
  add_jkr(cases);
  add_stronge(cases);
  add_shell(cases);
  return cases;
}

}  // namespace impactdic::sim::verify
