// Impacts from all over the range of each law, and what must hold of every one of them.
#pragma once

#include <impactdic/error.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>

#include "sim/contact/impact.h"

namespace impactdic::support {

using LawPair = std::pair<NormalModel, FrictionModel>;

// Every law that claims to break no law of physics. Full sliding adds energy by its rule.
inline constexpr LawPair kSoundLaws[] = {
    {NormalModel::kLinearSpringDamper, FrictionModel::kNone},
    {NormalModel::kLinearSpringDamper, FrictionModel::kCoulomb},
    {NormalModel::kLinearSpringDamper, FrictionModel::kThreePhase},
    {NormalModel::kLinearSpringDamper, FrictionModel::kBrody},
    {NormalModel::kHertzDamper, FrictionModel::kCoulomb},
    {NormalModel::kHertzDamper, FrictionModel::kThreePhase},
    {NormalModel::kHertzDamper, FrictionModel::kMawBarberFawcett},
    {NormalModel::kJacksonGreen, FrictionModel::kNone},
    {NormalModel::kJacksonGreen, FrictionModel::kCoulomb},
    {NormalModel::kKogutEtsion, FrictionModel::kNone},
    {NormalModel::kKogutEtsion, FrictionModel::kCoulomb},
    {NormalModel::kThornton, FrictionModel::kNone},
    {NormalModel::kThornton, FrictionModel::kCoulomb},
    {NormalModel::kLinearSpringDamper, FrictionModel::kSpeedDependent},
    {NormalModel::kHertzDamper, FrictionModel::kSpeedDependent},
    {NormalModel::kTsuji, FrictionModel::kNone},
    {NormalModel::kTsuji, FrictionModel::kCoulomb},
    {NormalModel::kKuwabaraKono, FrictionModel::kNone},
    {NormalModel::kKuwabaraKono, FrictionModel::kCoulomb},
    {NormalModel::kHuntCrossley, FrictionModel::kNone},
    {NormalModel::kHuntCrossley, FrictionModel::kCoulomb},
    {NormalModel::kWaltonBraun, FrictionModel::kNone},
    {NormalModel::kWaltonBraun, FrictionModel::kCoulomb},
    {NormalModel::kStronge, FrictionModel::kNone},
    {NormalModel::kStronge, FrictionModel::kCoulomb},
    {NormalModel::kJkr, FrictionModel::kNone},
    {NormalModel::kJkr, FrictionModel::kCoulomb},
    {NormalModel::kLinearSpringDamper, FrictionModel::kMindlin},
    {NormalModel::kWaltonBraun, FrictionModel::kMindlin},
    {NormalModel::kTsuji, FrictionModel::kMindlin},
    {NormalModel::kKuwabaraKono, FrictionModel::kMindlin},
    {NormalModel::kHuntCrossley, FrictionModel::kMindlin},
    {NormalModel::kThornton, FrictionModel::kMindlin},
    {NormalModel::kStronge, FrictionModel::kMindlin},
    {NormalModel::kLinearSpringDamper, FrictionModel::kTangentialSpring},
    {NormalModel::kHertzDamper, FrictionModel::kTangentialSpring},
    {NormalModel::kJacksonGreen, FrictionModel::kTangentialSpring},
    {NormalModel::kKogutEtsion, FrictionModel::kTangentialSpring},
    {NormalModel::kJkr, FrictionModel::kTangentialSpring},
    {NormalModel::kLinearSpringDamper, FrictionModel::kGripSlip},
    {NormalModel::kHertzDamper, FrictionModel::kGripSlip},
    {NormalModel::kTsuji, FrictionModel::kGripSlip}};

// Laws that have a static friction beside the kinetic one.
inline bool two_frictions(FrictionModel law) {
  return law == FrictionModel::kThreePhase || law == FrictionModel::kSpeedDependent ||
         law == FrictionModel::kGripSlip;
}

class RandomShots {
 public:
  explicit RandomShots(std::uint32_t seed) : random_(seed) {}

  double between(double low, double high) { return low + (high - low) * unit_(random_); }
  double decades(double low, double high) { return std::pow(10, between(low, high)); }

  // Friction 0 to 1.5, Poisson's ratio 0 to 0.5, grazing to normal, backspin to topspin, damping
  // ratio 0 to 1.2, gravity or none, slopes to 60 degrees.
  ImpactJob next(const LawPair& laws) {
    ImpactJob job;
    job.normal = laws.first;
    job.friction = laws.second;
    job.body.shape = between(0, 1) < 0.5 ? BodyShape::kSolidSphere : BodyShape::kHollowSphere;
    job.body.mass_kg = decades(-4, 1);
    job.body.diameter_m = decades(-2.5, -0.5);
    const double speed = decades(-1, 1.5), grazing = std::acos(between(0.05, 1));
    job.initial = {(between(0, 1) < 0.5 ? -1 : 1) * speed * std::sin(grazing),
                   -speed * std::cos(grazing), between(-2, 2) * speed / job.body.radius_m()};
    job.gravity_m_s2 = between(0, 1) < 0.5 ? 9.81 : 0;
    job.surface_angle_deg = between(-60, 60);
    contact(job);
    return job;
  }

  // The same with motion and spin across the plane, and a weight on a slope that turns the slip. No
  // spring remembers a slip that turns, so such a ball has no weight.
  ImpactJob next_in_space(const LawPair& laws) {
    ImpactJob job = next(laws);
    const double speed = std::hypot(job.initial.vt_m_s, job.initial.vn_m_s);
    job.initial.vb_m_s = between(-1, 1) * speed;
    job.initial.omega_t_rad_s = between(-2, 2) * speed / job.body.radius_m();
    job.initial.omega_n_rad_s = between(-2, 2) * speed / job.body.radius_m();
    if (remembers_slip(laws.second)) job.gravity_m_s2 = 0;
    return job;
  }

 private:
  void contact(ImpactJob& job) {
    ContactParameters& c = job.contact;
    c.friction_kinetic = between(0.001, 1.5);
    c.friction_static = c.friction_kinetic * between(1, 1.5);
    c.poisson = between(0, 0.5);
    const double mass = job.body.mass_kg, radius = job.body.radius_m();
    const double vn = -job.initial.vn_m_s;
    const double zeta = between(0, 1) < 0.3 ? 0.0 : between(0, 1.2);
    c.restitution_damping = static_cast<RestitutionDamping>(static_cast<int>(between(0, 2)));
    const double depth = radius * decades(-3, -0.8);  // of the undamped contact
    if (job.friction == FrictionModel::kSpeedDependent) {
      c.friction_speed_m_s = vn * decades(-1.5, 1);
    }
    if (has_hertz_spring(job.normal)) {
      c.stiffness = 1.25 * mass * vn * vn / std::pow(depth, 2.5);
      damped_hertz(job, zeta);
    } else if (!stiffness_key(job.normal).empty()) {
      c.stiffness = mass * vn * vn / (depth * depth);
      c.damping_n_s_per_m = 2 * zeta * std::sqrt(c.stiffness * mass);
      if (job.normal == NormalModel::kWaltonBraun) {
        c.unloading_stiffness_n_per_m = c.stiffness * decades(0, 1.5);
        c.unloading_hardening_per_m = zeta / depth;
      }
    } else if (job.normal == NormalModel::kJkr) {
      adhesive(job, depth);
    } else {
      plastic(job);
    }
    if (remembers_slip(job.friction) && !slips_partially(job.friction)) {
      // About as stiff along the surface as out of it.
      const double into = job.body.mass_kg * vn * vn / (depth * depth);
      c.tangential_stiffness_n_per_m = into * decades(-1, 1);
    }
  }

  void damped_hertz(ImpactJob& job, double zeta) {
    ContactParameters& c = job.contact;
    const double mass = job.body.mass_kg, vn = -job.initial.vn_m_s;
    const double slowness = std::pow(mass / c.stiffness, 0.4) * std::pow(vn, -0.2);
    c.damping_n_s_per_m =
        zeta * std::pow(mass, 0.6) * std::pow(c.stiffness, 0.4) * std::pow(vn, 0.2);
    c.damping_factor = std::sqrt(5) * zeta;
    c.dissipation_s = zeta * slowness;
    c.damping_s_per_m = 2 * zeta / vn;
    if (job.normal != NormalModel::kHertzDamper) {
      const bool pulls = c.restitution_damping == RestitutionDamping::kNone && zeta < 0.8;
      c.restitution_damping =
          pulls ? RestitutionDamping::kToZeroDeflection : RestitutionDamping::kToZeroForce;
    }
  }

  // From hardly adhesive to such as stick.
  void adhesive(ImpactJob& job, double depth) {
    ContactParameters& c = job.contact;
    const double radius = job.body.radius_m(), vn = -job.initial.vn_m_s;
    c.reduced_modulus_pa = decades(6, 11.5);
    c.restitution_damping = RestitutionDamping::kNone;
    const double energy =
        0.4 * 4.0 / 3 * c.reduced_modulus_pa * std::sqrt(radius * depth) * depth * depth;
    job.body.mass_kg = 2 * energy / (vn * vn);
    const double lost = decades(-5, 0.3) * energy;  // 7.09 (w^5 R^4/E*^2)^(1/3)
    c.adhesion_j_per_m2 = std::pow(std::pow(lost / 7.09, 3) * c.reduced_modulus_pa *
                                       c.reduced_modulus_pa / std::pow(radius, 4),
                                   0.2);
  }

  // From before yield to x = 110.
  void plastic(ImpactJob& job) {
    ContactParameters& c = job.contact;
    const double radius = job.body.radius_m(), vn = -job.initial.vn_m_s;
    c.damping_n_s_per_m = 0;
    c.restitution_damping = RestitutionDamping::kNone;
    c.residual = between(0, 1) < 0.5 ? ResidualLaw::kJackson : ResidualLaw::kKogutEtsion;
    c.reduced_modulus_pa = decades(9, 11.5);
    const double strain = decades(-3, -1.7);  // yield strength over modulus
    c.yield_strength_pa = strain * c.reduced_modulus_pa;
    const double constant = 1.295 * std::exp(0.736 * c.poisson);
    const double ratio = 3.14159265358979 * constant * strain / 2;
    const double critical_j = 0.4 * 4.0 / 3 * c.reduced_modulus_pa * std::sqrt(radius) *
                              std::pow(ratio * ratio * radius, 2.5);
    job.body.mass_kg = 2 * critical_j * decades(-1, 4) / (vn * vn);
  }

  std::mt19937 random_;
  std::uniform_real_distribution<double> unit_{0, 1};
};

// What a shot breaks; empty where all is well. `seconds` is how long it took.
inline std::string broken_law(const ImpactJob& job, double& seconds) {
  const auto begin = std::chrono::steady_clock::now();
  ImpactResult r;
  try {
    r = sim::contact::simulate_impact(job);
  } catch (const Error& error) {
    return error.what();
  }
  seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const double energy = r.energy.kinetic_start_j;
  const double flow = std::max(energy, std::abs(r.energy.gravity_j));
  if (!(std::abs(r.energy.residual_j) <= 1e-9 * energy + 1e-12 * flow)) {
    return "energy left over: " + std::to_string(r.energy.residual_j / energy);
  }
  // The weight may add to the rebound, hence the last term.
  const double lift = job.gravity_m_s2 * r.contact_s / -job.initial.vn_m_s;
  if (r.separated && r.restitution > 1 + 1e-9 + lift) {
    return "restitution " + std::to_string(r.restitution);
  }
  for (const ContactPhase& phase : r.phases) {
    if (phase.slip_j < -1e-9 * flow)
      return "friction does positive work while " + std::string(phase.name);
  }
  // Where the surface pulls, the impulse is less than that of the pressure.
  const ContactParameters& c = job.contact;
  const bool pulls = job.normal == NormalModel::kJkr ||
                     c.restitution_damping == RestitutionDamping::kToZeroDeflection;
  const double friction = two_frictions(job.friction) ? c.friction_static : c.friction_kinetic;
  if (r.separated && !pulls &&
      std::hypot(r.impulse_t_n_s, r.impulse_b_n_s) >
          (1 + 1e-9) * friction * r.impulse_n_n_s +
              1e-10 * job.body.mass_kg * std::hypot(job.initial.vt_m_s, job.initial.vn_m_s)) {
    return "more friction than the normal impulse allows";
  }
  // A stiff spring along the surface swings hundreds of times while the contact lasts, which takes
  // some 500 right-hand sides each time.
  const double mobility = (1 + 1 / job.body.inertia_factor()) / job.body.mass_kg;
  const double swings =
      remembers_slip(job.friction) && !slips_partially(job.friction)
          ? std::sqrt(c.tangential_stiffness_n_per_m * mobility) * r.contact_s / 6.283
          : 0;
  if (r.evaluations > 60000 + 600 * swings && r.separated) {
    return "takes " + std::to_string(r.evaluations);
  }
  return "";
}

}  // namespace impactdic::support
