// Friction of contacts that give way along the surface: partial slip under any normal law, and the
// spring that sticks or slips as a whole.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/contact/impact.h"
#include "sim/contact/law/normal_elastoplastic.h"
#include "sim/job/source_jobs.h"

namespace impactdic {
namespace {

double tip(const ImpactJob& job) { return sim::contact::simulate_impact(job).tip_vt_final_m_s; }

ImpactJob rubber(NormalModel normal, FrictionModel friction) {
  ImpactJob job = sim::job::wood_sound_job();
  job.gravity_m_s2 = 0;
  job.normal = normal;
  job.friction = friction;
  job.contact.damping_n_s_per_m = 0;
  job.contact.restitution_damping = RestitutionDamping::kToZeroForce;
  return job;
}

ImpactJob steel(NormalModel normal, double speed) {
  ImpactJob job;
  job.normal = normal;
  job.friction = FrictionModel::kMindlin;
  job.body = {BodyShape::kSolidSphere, 0.0327, 0.02};
  job.contact.reduced_modulus_pa = 109e9;
  job.contact.yield_strength_pa = 300e6;
  job.contact.poisson = 0.3;
  job.contact.friction_kinetic = 0.3;
  job.gravity_m_s2 = 0;
  job.initial.vn_m_s = -speed;
  return job;
}

TEST(ElasticFriction, MindlinUnderHertzIsMawBarberAndFawcett) {
  const double exact = tip(rubber(NormalModel::kHertzDamper, FrictionModel::kMawBarberFawcett));
  EXPECT_EQ(tip(rubber(NormalModel::kHertzDamper, FrictionModel::kMindlin)), exact);
  // Without damping the others are the same contact.
  for (const NormalModel normal :
       {NormalModel::kTsuji, NormalModel::kKuwabaraKono, NormalModel::kHuntCrossley}) {
    EXPECT_NEAR(tip(rubber(normal, FrictionModel::kMindlin)), exact, 1e-9) << name_of(normal);
  }
}

// Below yield a plastic law is Hertz's.
TEST(ElasticFriction, BelowYieldPlasticLawsSlipAsElasticOnes) {
  for (const NormalModel normal : {NormalModel::kThornton, NormalModel::kStronge}) {
    for (const double ratio : {0.2, 0.6, 1.5}) {
      ImpactJob job = steel(normal, 1e-3);
      job.initial.vt_m_s = ratio * 1e-3;
      ImpactJob elastic = job;
      elastic.normal = NormalModel::kHertzDamper;
      elastic.friction = FrictionModel::kMawBarberFawcett;
      elastic.contact.stiffness = hertz_stiffness(109e9, 0.01);
      EXPECT_NEAR(tip(job), tip(elastic), 1e-9 * 1e-3) << name_of(normal) << " " << ratio;
    }
  }
}

// Jackson and Green's force falls by a step at 1.9 times the yield's compression: a spring that is
// about to come loose does so there, and what it gives up counts as slip.
TEST(ElasticFriction, AForceThatDropsLetsAStretchedSpringGo) {
  ImpactJob job = steel(NormalModel::kJacksonGreen, 0.090847);
  job.friction = FrictionModel::kTangentialSpring;
  job.body = {BodyShape::kSolidSphere, 0.929783, 2 * 0.0290001};
  job.contact.reduced_modulus_pa = 2.45634e9;
  job.contact.yield_strength_pa = 1.19987e7;
  job.contact.poisson = 0.37214;
  job.contact.friction_kinetic = 0.402481;
  job.contact.tangential_stiffness_n_per_m = 100885;
  job.contact.residual = ResidualLaw::kKogutEtsion;
  job.initial.vt_m_s = -0.883825;
  const ImpactResult result = sim::contact::simulate_impact(job);
  EXPECT_TRUE(result.separated);
  EXPECT_NEAR(result.energy.residual_j, 0, 1e-9 * result.energy.kinetic_start_j);
}

// Springs followed one by one, pressed by the Hertz contact that carries the plastic law's force.
double springs_tip(const ImpactJob& job, PlasticLoading loading, int springs, int steps) {
  const double m = job.body.mass_kg, radius = job.body.radius_m(), inertia = job.body.inertia();
  const ContactParameters& c = job.contact;
  const sim::contact::ElasticPlasticLaw law(
      {radius, c.reduced_modulus_pa, c.yield_strength_pa, c.poisson}, loading, c.residual);
  const double ratio = 2 * (1 - c.poisson) / (2 - c.poisson), alpha = c.friction_kinetic / ratio;
  const double k = hertz_stiffness(c.reduced_modulus_pa, radius), speed = -job.initial.vn_m_s;
  const double largest = law.largest_compression_m(m, speed);
  const double reach = std::pow(law.loading_force_n(largest) / k, 2.0 / 3);
  const double dx = std::sqrt(radius * reach * 1.001) / springs, dt = 3 * largest / speed / steps;
  const double residual = law.residual_m(largest);
  std::vector<double> u(springs, 0.0);
  double delta = 0, rate = speed, vt = job.initial.vt_m_s, omega = job.initial.omega_rad_s;
  double tangential = 0, normal = 0;
  for (int step = 0; step < 4 * steps; ++step) {
    rate -= 0.5 * dt * normal / m;
    vt += 0.5 * dt * tangential / m;
    omega += 0.5 * dt * radius * tangential / inertia;
    delta += dt * rate;
    normal =
        rate > 0 ? law.loading_force_n(delta) : law.unloading_force_n(delta, largest, residual);
    if (rate <= 0 && normal <= 0) break;
    const double depth = std::pow(normal / k, 2.0 / 3), way = dt * (vt + radius * omega);
    double sum = 0;
    for (int i = 0; i < springs; ++i) {
      const double bound = alpha * (depth - std::pow((i + 0.5) * dx, 2) / radius);
      u[i] = bound > 0 ? std::clamp(u[i] + way, -bound, bound) : 0.0;
      sum += u[i];
    }
    tangential = -2 * ratio * c.reduced_modulus_pa * sum * dx;
    rate -= 0.5 * dt * normal / m;
    vt += 0.5 * dt * tangential / m;
    omega += 0.5 * dt * radius * tangential / inertia;
  }
  return vt + radius * omega;
}

TEST(ElasticFriction, PlasticPartialSlipIsTheLimitOfManySprings) {
  const double speed = 0.2;
  for (const auto& [normal, loading] :
       {std::pair{NormalModel::kThornton, PlasticLoading::kThornton},
        std::pair{NormalModel::kStronge, PlasticLoading::kStronge}}) {
    for (const double ratio : {0.15, 0.5, 1.0, 1.4}) {
      ImpactJob job = steel(normal, speed);
      job.initial.vt_m_s = ratio * speed;
      const double few = springs_tip(job, loading, 300, 6000);
      const double many = springs_tip(job, loading, 600, 12000);
      // The reference's own error is about what doubling its springs changes.
      const double allowed = 2e-4 * speed + std::abs(many - few);
      EXPECT_NEAR(tip(job), 2 * many - few, allowed) << name_of(normal) << " " << ratio;
      EXPECT_LT(std::abs(many - few), 2e-3 * speed);
    }
  }
}

// Stronge's bilinear contact in steps so small that the clipped spring shows its own error.
double bilinear_tip(const ImpactJob& job, double stiffness, int steps) {
  const double m = job.body.mass_kg, radius = job.body.radius_m(), inertia = job.body.inertia();
  const double k = job.contact.stiffness, mu = job.contact.friction_kinetic;
  const double omega0 = std::sqrt(k / m), speed = -job.initial.vn_m_s;
  const double duration = 3.14159265358979323846 / omega0, dt = duration / steps;
  double vt = job.initial.vt_m_s, spin = job.initial.omega_rad_s, stretch = 0;
  for (int step = 0; step < steps; ++step) {
    const double load = k * speed / omega0 * std::sin(omega0 * (step + 0.5) * dt);
    stretch += dt * (vt + radius * spin);
    const double most = mu * load / stiffness;
    stretch = std::clamp(stretch, -most, most);
    vt -= dt * stiffness * stretch / m;
    spin -= dt * radius * stiffness * stretch / inertia;
  }
  return vt + radius * spin;
}

TEST(ElasticFriction, ALinearContactSticksOrSlipsAsAWhole) {
  ImpactJob job = sim::job::racket_job();
  job.gravity_m_s2 = 0;
  job.surface_angle_deg = 0;
  job.contact.damping_n_s_per_m = 0;
  job.contact.poisson = 0.3;
  job.contact.friction_kinetic = 0.4;
  job.initial.vn_m_s = -2;
  const double stiffness = job.contact.stiffness * 2 * 0.7 / 1.7;
  for (const double vt : {0.1, 0.6, 1.2, 2.5, 6.0}) {
    job.initial.vt_m_s = vt;
    job.friction = FrictionModel::kMindlin;
    const double partial = tip(job);
    EXPECT_NEAR(partial, bilinear_tip(job, stiffness, 400000), 2e-5 * 2) << vt;
    job.friction = FrictionModel::kTangentialSpring;
    job.contact.tangential_stiffness_n_per_m = stiffness;
    EXPECT_NEAR(tip(job), partial, 1e-11) << vt;  // but for rounding
    // As much friction to come loose as to slip: nothing distinguishes them.
    job.friction = FrictionModel::kGripSlip;
    job.contact.friction_static = 0.4;
    EXPECT_NEAR(tip(job), partial, 1e-11) << vt;  // but for rounding
  }
}

// The tip springs back where the contact grips: Cross's overspin, which no rigid law gives.
TEST(ElasticFriction, GripReversesTheContactPoint) {
  ImpactJob job = sim::job::racket_job();
  job.gravity_m_s2 = 0;
  job.surface_angle_deg = 0;
  job.initial = {};
  job.initial.vn_m_s = -2;
  job.initial.vt_m_s = 0.8;
  job.contact.friction_kinetic = 0.4;
  job.contact.friction_static = 0.8;
  job.contact.tangential_stiffness_n_per_m = 0.8 * job.contact.stiffness;
  job.friction = FrictionModel::kGripSlip;
  const ImpactResult grips = sim::contact::simulate_impact(job);
  EXPECT_LT(grips.tip_vt_final_m_s, -0.05);
  const ContactPhase* stuck = nullptr;
  for (const ContactPhase& phase : grips.phases) {
    if (std::string(phase.name) == "sticking") stuck = &phase;
  }
  ASSERT_NE(stuck, nullptr);
  // What the spring loses as it comes loose is in the ledger.
  EXPECT_NEAR(grips.energy.residual_j / grips.energy.kinetic_start_j, 0, 1e-9);
  job.friction = FrictionModel::kCoulomb;
  EXPECT_NEAR(tip(job), 0, 1e-9);
}

TEST(ElasticFriction, GrossSlipObeysCoulomb) {
  for (const NormalModel normal :
       {NormalModel::kTsuji, NormalModel::kKuwabaraKono, NormalModel::kHuntCrossley}) {
    ImpactJob job = rubber(normal, FrictionModel::kMindlin);
    job.contact.damping_factor = 0.3;
    job.contact.dissipation_s = 3e-4;
    job.contact.damping_s_per_m = 0.2;
    job.contact.friction_kinetic = 0.2;
    job.initial.vt_m_s = 20;
    const ImpactResult r = sim::contact::simulate_impact(job);
    EXPECT_NEAR(-r.impulse_t_n_s / r.impulse_n_n_s, 0.2, 1e-9) << name_of(normal);
  }
}

TEST(ElasticFriction, WhatALawCannotFollowIsRefused) {
  const auto refused = [](NormalModel normal, FrictionModel friction) {
    ImpactJob job = steel(normal, 0.1);
    job.friction = friction;
    job.contact.adhesion_j_per_m2 = 0.1;
    try {
      sim::contact::simulate_impact(job);
    } catch (const InvalidArgument& error) {
      return error.where();
    }
    return std::string();
  };
  EXPECT_EQ(refused(NormalModel::kJacksonGreen, FrictionModel::kMindlin), "normal");
  EXPECT_EQ(refused(NormalModel::kJkr, FrictionModel::kMindlin), "normal");
  EXPECT_EQ(refused(NormalModel::kThornton, FrictionModel::kMawBarberFawcett), "normal");
  EXPECT_EQ(refused(NormalModel::kThornton, FrictionModel::kTangentialSpring),
            "contact.tangential_stiffness_n_per_m");
  EXPECT_EQ(refused(NormalModel::kThornton, FrictionModel::kMindlin), "");
}

// 5 mm of alumina on glass at 3.9 m/s, nothing fitted (docs/models.md).
TEST(ElasticFriction, AluminaOnGlassReboundsAsMeasured) {
  double sum = 0;
  const std::pair<double, double> measured[] = {{9.496, 0.67257},  {20.012, 0.59691},
                                                {30.127, 0.68756}, {39.382, 0.77148},
                                                {49.694, 0.84761}, {60.02, 0.90142}};
  for (const auto& [angle, ratio] : measured) {
    const ImpactResult r = sim::contact::simulate_impact(sim::job::alumina_job(angle));
    EXPECT_NEAR(r.restitution, 0.98, 1e-9);
    sum += std::pow(r.final.vt_m_s / r.start.vt_m_s - ratio, 2);
  }
  EXPECT_LT(std::sqrt(sum / std::size(measured)), 0.03);
}

// A Hertz load grows from nothing more slowly than the spring is stretched: it slips first, for a
// time that is shorter than the first step.
TEST(TangentialSpring, SlipsAtTheTouchUnderALoadThatGrowsFromNothing) {
  ImpactJob job;
  job.normal = NormalModel::kHertzDamper;
  job.friction = FrictionModel::kGripSlip;
  job.body = {BodyShape::kHollowSphere, 0.41, 0.218};
  job.contact.stiffness = 615;
  job.contact.friction_kinetic = 1.47, job.contact.friction_static = 1.87;
  job.contact.tangential_stiffness_n_per_m = 44.8;
  job.initial = {-0.0146, -0.188, -0.0963};
  job.gravity_m_s2 = 0;
  ImpactJob strict = job;
  strict.solver.relative_tolerance = 1e-13;
  const ImpactResult usual = sim::contact::simulate_impact(job);
  const ImpactResult exact = sim::contact::simulate_impact(strict);
  EXPECT_NEAR(usual.tip_vt_final_m_s, exact.tip_vt_final_m_s, 1e-9 * 0.188);
  EXPECT_EQ(std::string(usual.phases[1].name), "sliding");
  EXPECT_GT(usual.phases[1].end_s, 0);
}

}  // namespace
}  // namespace impactdic
