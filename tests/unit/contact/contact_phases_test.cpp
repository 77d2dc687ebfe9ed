// The phases of a contact: they cover it, they do not chatter, their energy is accounted for.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sim/contact/impact.h"
#include "sim/job/source_jobs.h"

namespace impactdic {
namespace {

const ContactPhase* find_phase(const ImpactResult& result, const std::string& name) {
  for (const ContactPhase& phase : result.phases) {
    if (phase.name == name) return &phase;
  }
  return nullptr;
}

TEST(Phases, NormalAndTangentialSequencesCoverTheContact) {
  for (const ImpactJob& job :
       {sim::job::racket_job(), sim::job::wood_published_job(), sim::job::wood_sound_job()}) {
    const ImpactResult result = sim::contact::simulate_impact(job);
    for (const ContactPhaseKind kind : {ContactPhaseKind::kNormal, ContactPhaseKind::kTangential}) {
      double reached = 0;
      for (const ContactPhase& phase : result.phases) {
        if (phase.kind != kind) continue;
        EXPECT_EQ(phase.start_s, reached);
        EXPECT_GT(phase.end_s, phase.start_s);
        reached = phase.end_s;
      }
      EXPECT_EQ(reached, result.contact_s);
    }
  }
}

TEST(Phases, RollingBallSlipsWhenFrictionCanNoLongerHoldIt) {
  ImpactJob job = sim::job::wood_published_job();
  job.preset = ModelPreset::kSound;
  job.friction = FrictionModel::kCoulomb;
  const ImpactResult result = sim::contact::simulate_impact(job);
  std::vector<std::string> names;
  for (const ContactPhase& phase : result.phases) {
    if (phase.kind == ContactPhaseKind::kTangential) names.push_back(phase.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"sliding", "rolling", "sliding"}));
  EXPECT_LT(find_phase(result, "rolling")->slip_j, 1e-12);
}

TEST(Phases, BallThatStartsAtRestTangentiallyDoesNotChatter) {
  for (const FrictionModel friction :
       {FrictionModel::kCoulomb, FrictionModel::kThreePhase, FrictionModel::kBrody,
        FrictionModel::kFullSliding, FrictionModel::kMawBarberFawcett}) {
    for (const double angle : {0.0, 20.0, -20.0}) {
      for (const ModelPreset preset : {ModelPreset::kPublished, ModelPreset::kSound}) {
        ImpactJob job = sim::job::wood_sound_job();
        job.friction = friction;
        job.preset = preset;
        job.contact.friction_static = 0.74;
        job.surface_angle_deg = angle;
        job.initial.vt_m_s = 0;
        const ImpactResult result = sim::contact::simulate_impact(job);
        EXPECT_TRUE(result.separated);
        EXPECT_LT(result.phases.size(), 12u);
        EXPECT_LT(result.evaluations, 20000);
      }
    }
  }
}

// Friction that is nothing, or next to it, takes hold of nothing and lets nothing chatter.
TEST(Phases, VanishingFrictionDoesNotChatter) {
  for (const double friction : {0.0, 1e-300, 1e-15, 1e-9}) {
    for (const FrictionModel law : {FrictionModel::kCoulomb, FrictionModel::kThreePhase,
                                    FrictionModel::kFullSliding, FrictionModel::kBrody}) {
      for (const ModelPreset preset : {ModelPreset::kPublished, ModelPreset::kSound}) {
        for (const double angle : {0.0, 20.0, -20.0}) {
          for (const double vt : {0.0, 0.01, 0.5}) {
            ImpactJob job = sim::job::wood_published_job();
            job.friction = law;
            job.preset = preset;
            job.contact.friction_kinetic = job.contact.friction_static = friction;
            job.surface_angle_deg = angle;
            job.initial.vt_m_s = vt;
            const ImpactResult result = sim::contact::simulate_impact(job);
            EXPECT_TRUE(result.separated);
            EXPECT_LT(result.phases.size(), 8u) << name_of(law) << " " << friction << " " << vt;
            EXPECT_LT(result.evaluations, 5000);
            // Brody as published holds a ball that rolls, by rule and not by friction.
            if (law == FrictionModel::kBrody && preset == ModelPreset::kPublished) continue;
            const double slide =
                vt - 9.81 * std::sin(angle * 3.14159265358979 / 180) * result.contact_s;
            EXPECT_NEAR(result.final.vt_m_s, slide, 1e-7) << name_of(law) << " " << friction;
          }
        }
      }
    }
  }
}

// Jobs from all over the range of each model: every one ends, and keeps the energy.
TEST(Phases, RandomJobsEndWithTheirEnergyAccountedFor) {
  std::mt19937 random(20240607);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto between = [&](double low, double high) { return low + (high - low) * unit(random); };
  for (int run = 0; run < 600; ++run) {
    ImpactJob job = sim::job::wood_sound_job();
    job.friction = static_cast<FrictionModel>(run % 6);
    job.preset = run / 6 % 2 == 0 ? ModelPreset::kPublished : ModelPreset::kSound;
    job.body.shape = run % 5 == 0 ? BodyShape::kHollowSphere : BodyShape::kSolidSphere;
    if (job.friction != FrictionModel::kMawBarberFawcett && run / 12 % 2 == 0) {
      job.normal = NormalModel::kLinearSpringDamper;
      job.contact.stiffness = std::pow(10, between(3.7, 6));  // never overdamped
    }
    job.contact.damping_n_s_per_m = run / 24 % 3 == 0 ? 0.0 : between(0, 20);
    job.contact.restitution_damping = static_cast<RestitutionDamping>(run / 72 % 3);
    job.contact.friction_kinetic = std::pow(10, between(-2, 0.3));
    job.contact.friction_static = job.contact.friction_kinetic * between(1, 2);
    job.contact.poisson = between(0, 0.5);
    job.surface_angle_deg = between(-60, 60);
    job.initial = {between(-4, 4), -std::pow(10, between(-0.5, 0.8)), between(-100, 100)};
    const ImpactResult result = sim::contact::simulate_impact(job);
    EXPECT_TRUE(result.separated) << run;
    EXPECT_NEAR(result.energy.residual_j / result.energy.kinetic_start_j, 0, 1e-9) << run;
    EXPECT_LT(result.evaluations, 10000) << run;
    if (job.preset == ModelPreset::kSound && job.friction != FrictionModel::kFullSliding) {
      for (const std::string& warning : result.warnings) {
        EXPECT_TRUE(warning.find("pulls") != std::string::npos ||
                    warning.find("outside the normal law's range") != std::string::npos)
            << run << ": " << warning;
      }
    }
  }
}

// Eq. 4.11 opposes the centre's velocity: a centre that stops while sticking stays stopped.
// Friction so strong that it stops the tip within a fraction of the first step: the slip that
// gravity begins is over before the middle of the step, and must be found all the same.
TEST(Phases, SlipThatEndsAtOnceDoesNotChatter) {
  ImpactJob job;
  job.friction = FrictionModel::kThreePhase;
  job.body.shape = BodyShape::kOther;
  job.body.mass_kg = 7.641193822935305e-05;
  job.body.diameter_m = 0.0048387523890673755;
  job.body.inertia_kg_m2 = 4.0174358752419344e-10;
  job.contact.stiffness = 142795.82429578865;
  job.contact.restitution_damping = RestitutionDamping::kToZeroDeflection;
  job.contact.friction_kinetic = 100;
  job.contact.friction_static = 200;
  job.surface_angle_deg = 45;
  job.initial = {6.751424378243684, -0.11784655088019452, -2790.5641104916954};
  const ImpactResult result = sim::contact::simulate_impact(job);
  EXPECT_TRUE(result.separated);
  EXPECT_NEAR(result.restitution, 1, 1e-9);
  EXPECT_LT(std::abs(result.energy.residual_j), 1e-9 * result.energy.kinetic_start_j);
  // The ball rolls: its spin and its way along the surface belong together.
  EXPECT_NEAR(result.tip_vt_final_m_s, 0, 1e-6 * job.initial.vt_m_s);
}

TEST(Phases, StickingCentreIsHeldOnceItStops) {
  ImpactJob job = sim::job::wood_published_job();
  job.initial = {0.3, -1.69, 0.9 / job.body.radius_m() * 0.1};
  job.contact.friction_static = 3;
  job.contact.friction_kinetic = 0.9;
  const ImpactResult result = sim::contact::simulate_impact(job, {.rate_hz = 1e6});
  const ContactPhase* sticking = find_phase(result, "sticking");
  ASSERT_NE(sticking, nullptr);
  bool held = false;
  for (const TrajectoryPoint& point : result.trajectory) {
    if (point.time_s <= sticking->start_s || point.time_s >= sticking->end_s) continue;
    EXPECT_GT(point.state.vt_m_s, -1e-9);
    held = held || std::abs(point.state.vt_m_s) < 1e-9;
  }
  EXPECT_TRUE(held);
}

}  // namespace
}  // namespace impactdic
