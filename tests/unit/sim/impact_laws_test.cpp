// What must hold of every impact by every law, and partial slip against springs followed one by
// one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/contact/impact.h"
#include "sim/job/source_jobs.h"
#include "sim/rod/rod_impact.h"
#include "tests/support/discrete_springs.h"
#include "tests/support/random_shots.h"

namespace impactdic {
namespace {

TEST(Laws, RandomShotsKeepEnergyAndCoulombsLaw) {
  for (const support::LawPair& laws : support::kSoundLaws) {
    support::RandomShots random(20261122);
    for (int i = 0; i < 60; ++i) {
      double seconds = 0;
      EXPECT_EQ(support::broken_law(random.next(laws), seconds), "")
          << name_of(laws.first) << ", " << name_of(laws.second) << ", shot " << i;
    }
  }
}

// The weight presses in a million times as deep as the yield: the work kept by the surface must be
// as exact there as the integration.
TEST(Laws, TheLedgerClosesFarBeyondYield) {
  for (double heavier = 1; heavier < 4; heavier += 0.1) {
    ImpactJob job;
    job.normal = NormalModel::kJacksonGreen;
    job.friction = FrictionModel::kNone;
    job.body = {BodyShape::kHollowSphere, 5.41483e7 * heavier, 0.246437};
    job.initial.vn_m_s = -0.0104323;
    job.contact.reduced_modulus_pa = 7.93885e9;
    job.contact.yield_strength_pa = 1.49487e8;
    job.contact.poisson = 0.490765;
    job.surface_angle_deg = 19.7321;
    const ImpactResult result = sim::contact::simulate_impact(job);
    EXPECT_FALSE(result.separated);
    EXPECT_NEAR(result.energy.residual_j / result.energy.gravity_j, 0, 1e-12) << heavier;
  }
}

// Sweeps live on it. It is 1570; steps that are made twice, or events that are looked
// for without the interpolant, take it above 1700.
TEST(Laws, AnImpactTakesFewRightHandSides) {
  long evaluations = 0;
  int shots = 0;
  for (const double speed : {0.5, 2.0, 5.0}) {
    for (double angle_deg = 4; angle_deg < 84; angle_deg += 8) {
      for (const double spin : {-0.7, 0.0, 0.4}) {
        ImpactJob job = sim::job::wood_sound_job();
        job.gravity_m_s2 = 0;
        const double angle = angle_deg * 3.14159265358979323846 / 180;
        job.initial = {speed * std::sin(angle), -speed * std::cos(angle),
                       spin * speed / job.body.radius_m()};
        evaluations += sim::contact::simulate_impact(job).evaluations;
        ++shots;
      }
    }
  }
  EXPECT_LT(evaluations / shots, 1650);
}

TEST(Laws, PartialSlipIsTheLimitOfManySprings) {
  for (const bool damped : {false, true}) {
    support::RandomShots random(314159);
    for (int run = 0; run < 20;) {
      ImpactJob job = random.next({NormalModel::kHertzDamper, FrictionModel::kMawBarberFawcett});
      job.gravity_m_s2 = 0;
      if (!damped) job.contact.damping_n_s_per_m = 0;
      if (damped && job.contact.damping_n_s_per_m == 0) continue;
      ++run;
      const double springs = support::discrete_springs_tip(job, 1000, 10000);
      const double speed = std::hypot(job.initial.vt_m_s, job.initial.vn_m_s,
                                      job.body.radius_m() * job.initial.omega_rad_s);
      const double ours = sim::contact::simulate_impact(job).tip_vt_final_m_s;
      EXPECT_NEAR(springs / speed, ours / speed, 1e-6) << "damped " << damped << ", shot " << run;
    }
  }
}

// A stuck core that a shrinking contact uncovers while the annulus still slips the other way: the
// cases in which the energy once jumped.
TEST(Laws, UncoveredCoreSlipsAtTheOtherBound) {
  for (const double poisson : {0.0, 0.15}) {
    for (const double psi : {0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.75}) {
      ImpactJob job = sim::job::wood_sound_job();
      job.gravity_m_s2 = 0;
      job.contact.damping_n_s_per_m = 0;
      job.contact.poisson = poisson;
      job.contact.friction_kinetic = 0.4;
      job.initial.vn_m_s = -1;
      job.initial.vt_m_s = psi * 0.4 * (2 - poisson) / (2 * (1 - poisson));
      const ImpactResult result = sim::contact::simulate_impact(job);
      EXPECT_NEAR(result.energy.residual_j / result.energy.kinetic_start_j, 0, 1e-9) << psi;
      const double springs = support::discrete_springs_tip(job, 1000, 10000);
      EXPECT_NEAR(result.tip_vt_final_m_s, springs, 1e-6) << poisson << " " << psi;
    }
  }
}

TEST(Laws, GrossSlipObeysCoulombWithADamper) {
  for (const RestitutionDamping damping :
       {RestitutionDamping::kNone, RestitutionDamping::kToZeroForce}) {
    for (const double b : {0.0, 5.0, 20.0, 60.0}) {
      ImpactJob job = sim::job::wood_sound_job();
      job.gravity_m_s2 = 0;
      job.contact.restitution_damping = damping;
      job.contact.damping_n_s_per_m = b;
      job.contact.friction_kinetic = 0.2;
      job.initial.vt_m_s = 20;
      const ImpactResult result = sim::contact::simulate_impact(job);
      EXPECT_NEAR(-result.impulse_t_n_s / result.impulse_n_n_s, 0.2, 1e-10) << b;
    }
  }
}

// Friction never exceeds what the whole normal force allows, at any time.
TEST(Laws, PartialSlipStaysBelowCoulombsLimit) {
  for (const RestitutionDamping damping :
       {RestitutionDamping::kNone, RestitutionDamping::kToZeroForce}) {
    ImpactJob job = sim::job::wood_sound_job();
    job.contact.restitution_damping = damping;
    for (const TrajectoryPoint& point :
         sim::contact::simulate_impact(job, {.rate_hz = 1e5}).trajectory) {
      EXPECT_LE(std::abs(point.tangential_force_n),
                job.contact.friction_kinetic * std::max(point.normal_force_n, 0.0) + 1e-6);
    }
  }
}

TEST(Laws, NothingComesBackFasterThanItCame) {
  for (const NormalModel normal :
       {NormalModel::kJacksonGreen, NormalModel::kKogutEtsion, NormalModel::kThornton}) {
    for (const ResidualLaw residual : {ResidualLaw::kJackson, ResidualLaw::kKogutEtsion}) {
      for (double speed = 0.001; speed < 3; speed *= 1.07) {
        ImpactJob job;
        job.normal = normal;
        job.friction = FrictionModel::kNone;
        job.body = {BodyShape::kSolidSphere, 0.0327, 0.02};
        job.contact.reduced_modulus_pa = 100e9;
        job.contact.yield_strength_pa = 1e9;
        job.contact.poisson = 0.3;
        job.contact.residual = residual;
        job.gravity_m_s2 = 0;
        job.initial.vn_m_s = -speed;
        EXPECT_LE(sim::contact::simulate_impact(job).restitution, 1 + 1e-9)
            << name_of(normal) << " " << speed;
      }
    }
  }
}

TEST(Laws, OutsideItsRangeALawSaysSo) {
  ImpactJob job;
  job.normal = NormalModel::kKogutEtsion;
  job.friction = FrictionModel::kNone;
  job.body = {BodyShape::kSolidSphere, 0.0327, 0.02};
  job.contact.reduced_modulus_pa = 100e9;
  job.contact.yield_strength_pa = 1e9;
  job.contact.poisson = 0.3;
  for (const NormalModel normal :
       {NormalModel::kKogutEtsion, NormalModel::kJacksonGreen, NormalModel::kThornton}) {
    job.normal = normal;
    job.initial.vn_m_s = -1;
    EXPECT_TRUE(sim::contact::simulate_impact(job).warnings.empty()) << name_of(normal);
    job.initial.vn_m_s = -900;
    const ImpactResult fast = sim::contact::simulate_impact(job);
    ASSERT_EQ(fast.warnings.size(), 1u) << name_of(normal);
    EXPECT_NE(fast.warnings[0].find("outside the normal law's range"), std::string::npos);
    EXPECT_GE(fast.restitution, 0);
  }
}

// A damper shifts the largest force to where dP/dt = 0: t with tan(w t) of the closed form.
TEST(Laws, LargestForceIsThatOfTheClosedForm) {
  for (const double zeta : {0.05, 0.3, 0.6, 0.9}) {
    ImpactJob job = sim::job::racket_job();
    job.gravity_m_s2 = 0;
    job.friction = FrictionModel::kNone;
    const double m = job.body.mass_kg, k = job.contact.stiffness;
    const double omega0 = std::sqrt(k / m), omega = omega0 * std::sqrt(1 - zeta * zeta);
    job.contact.damping_n_s_per_m = 2 * zeta * std::sqrt(k * m);
    const double v = -job.initial.vn_m_s, b = job.contact.damping_n_s_per_m;
    const auto force = [&](double t) {
      const double decay = v * std::exp(-zeta * omega0 * t);
      const double deflection = decay / omega * std::sin(omega * t);
      const double rate =
          decay * (std::cos(omega * t) - zeta * omega0 / omega * std::sin(omega * t));
      return k * deflection + b * rate;
    };
    double largest = 0;
    const double end = std::acos(zeta) / omega;
    for (int i = 0; i <= 200000; ++i) largest = std::max(largest, force(end * i / 200000));
    EXPECT_NEAR(sim::contact::simulate_impact(job).peak_force_n / largest, 1, 1e-9) << zeta;
  }
}

// The lever of a rod reaches to the lowest point of its round end.
TEST(Laws, RodTouchesWithItsCap) {
  ImpactJob job;
  job.normal = NormalModel::kJacksonGreen;
  job.friction = FrictionModel::kCoulomb;
  job.body = {BodyShape::kRod, 0.5784, 0.0176, 0.3048};
  job.contact.reduced_modulus_pa = 109.1823e9;
  job.contact.yield_strength_pa = 300e6;
  job.contact.poisson = 0.29;
  job.contact.friction_kinetic = 0.13;
  job.initial.vn_m_s = -2.487;
  job.initial.angle_deg = 45;
  const ImpactResult result = sim::contact::simulate_impact(job);
  RodJob rod = rigid_rod_preset();
  rod.angle_rad = job.initial.angle_deg * 3.14159265358979323846 / 180;
  rod.vn_m_s = job.initial.vn_m_s;
  const RodImpact other = sim::rod::simulate_rod(rod);
  EXPECT_NEAR(result.final.omega_rad_s, other.omega_rad_s, 1e-6 * std::abs(other.omega_rad_s));
  EXPECT_NEAR(result.restitution, other.restitution, 1e-6);
}

}  // namespace
}  // namespace impactdic
