// The normal laws beside the dissertation's: their jobs, their limits, what they refuse.
#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <impactdic/units.h>

#include <cmath>
#include <fstream>

#include "sim/contact/impact.h"
#include "sim/job/job_toml.h"
#include "sim/job/source_jobs.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

const char* const kBall = R"(friction = "coulomb"
[body]
shape = "solid_sphere"
mass_kg = 0.15
diameter_m = 0.063
[initial]
vt_m_s = 0.5
vn_m_s = -1.5
)";

SimulateRequest read(const std::string& text) {
  const testing::ScratchFolder folder;
  const std::filesystem::path file = folder / "job.toml";
  std::ofstream(file) << text;
  return sim::job::read_simulate_job(file);
}

std::string job_of(const std::string& normal, const std::string& constants) {
  return "normal = \"" + normal + "\"\n" + kBall + "[contact]\nfriction_kinetic = 0.4\n" +
         constants;
}

// An error's text and place, or nothing.
std::string refusal(const std::string& normal, const std::string& constants) {
  try {
    read(job_of(normal, constants));
  } catch (const InvalidArgument& error) {
    return std::string(error.where()) + ": " + error.what() + " (" + error.hint() + ")";
  }
  return "";
}

struct Law {
  const char* name;
  const char* constants;
};
constexpr Law kLaws[] = {
    {"tsuji", "stiffness_n_per_m1p5 = 875000.0\ndamping_factor = 0.2\n"},
    {"kuwabara_kono", "stiffness_n_per_m1p5 = 875000.0\ndissipation_s = 2e-4\n"},
    {"hunt_crossley", "stiffness_n_per_m1p5 = 875000.0\ndamping_s_per_m = 0.1\n"},
    {"walton_braun", "stiffness_n_per_m = 40000.0\nunloading_stiffness_n_per_m = 60000.0\n"},
    {"walton_braun", "stiffness_n_per_m = 40000.0\nunloading_hardening_per_m = 50.0\n"},
    {"stronge_elastoplastic", "reduced_modulus_pa = 1e9\nyield_strength_pa = 4e6\n"},
    {"jkr", "reduced_modulus_pa = 3e6\nadhesion_j_m2 = 20.0\n"}};

TEST(NormalLaws, TheResolvedJobReadsBackToTheSameBytes) {
  for (const Law& law : kLaws) {
    const SimulateRequest job = read(job_of(law.name, law.constants));
    const std::string resolved = sim::job::to_toml(job);
    EXPECT_EQ(sim::job::to_toml(read(resolved)), resolved) << law.name;
    const ImpactResult once = sim::contact::simulate_impact(job.impact);
    const ImpactResult again = sim::contact::simulate_impact(read(resolved).impact);
    EXPECT_EQ(once.restitution, again.restitution) << law.name;
    EXPECT_LT(once.restitution, 1) << law.name;
    EXPECT_GT(once.restitution, 0.3) << law.name;
  }
}

TEST(NormalLaws, AWrongConstantIsNamed) {
  EXPECT_NE(refusal("tsuji", "stiffness_n_per_m1p5 = 875000.0\ndamping_n_s_per_m = 3.0\n")
                .find("tsuji takes damping_factor"),
            std::string::npos);
  EXPECT_NE(refusal("kuwabara_kono", "stiffness_n_per_m = 875000.0\n").find("stiffness_n_per_m1p5"),
            std::string::npos);
  EXPECT_NE(refusal("walton_braun", "stiffness_n_per_m = 4e4\nunloading_stiffness_n_per_m = 3e4\n")
                .find("must be at least stiffness_n_per_m"),
            std::string::npos);
  EXPECT_NE(refusal("jkr", "reduced_modulus_pa = 3e6\n").find("adhesion_j_m2"), std::string::npos);
  EXPECT_NE(refusal("jkr", "reduced_modulus_pa = 3e6\nadhesion_j_m2 = -1.0\n")
                .find("must not be negative"),
            std::string::npos);
  EXPECT_NE(refusal("tsuji", "stiffness_n_per_m1p5 = 8e5\nrestitution_damping = \"none\"\n")
                .find("damps the restitution, too"),
            std::string::npos);
  EXPECT_NE(refusal("hunt_crossley", "stiffness_n_per_m1p5 = 8e5\nrestitution_damping = \"none\"\n")
                .find("never pulls"),
            std::string::npos);
}

// The damping that a restitution at a speed asks for gives just that restitution.
TEST(NormalLaws, ARestitutionGivesTheConstant) {
  for (const char* law : {"tsuji", "kuwabara_kono", "hunt_crossley"}) {
    std::string constants = "stiffness_n_per_m1p5 = 875000.0\nrestitution = 0.8\n";
    if (std::string(law) != "tsuji") constants += "restitution_speed_m_s = 1.5\n";
    const SimulateRequest given = read(job_of(law, constants));
    ImpactJob job = given.impact;
    job.gravity_m_s2 = 0;
    EXPECT_NEAR(sim::contact::simulate_impact(job).restitution, 0.8, 1e-10) << law;
    const std::string resolved = sim::job::to_toml(given);
    EXPECT_EQ(sim::job::to_toml(read(resolved)), resolved) << law;
  }
  const SimulateRequest given =
      read(job_of("walton_braun", "stiffness_n_per_m = 40000.0\nrestitution = 0.8\n"));
  EXPECT_DOUBLE_EQ(given.impact.contact.unloading_stiffness_n_per_m, 40000 / 0.64);
}

// Materials give the stiffness of every Hertz contact.
TEST(NormalLaws, MaterialsGiveTheStiffness) {
  const char* const materials = R"([surface]
young_pa = 1e9
poisson = 0.3
)";
  for (const char* law : {"hertz_damper", "tsuji", "kuwabara_kono", "hunt_crossley"}) {
    std::string text = job_of(law, "") + materials;
    text.insert(text.find("mass_kg"), "young_pa = 2e6\npoisson = 0.49\n");
    const ImpactJob job = read(text).impact;
    const double modulus = reduced_modulus_pa({2e6, 0.49}, {1e9, 0.3});
    EXPECT_DOUBLE_EQ(job.contact.stiffness, hertz_stiffness(modulus, 0.0315)) << law;
  }
}

// Too slow a sphere sticks; the energy is in the contact and the ledger closes.
TEST(NormalLaws, ASlowAdhesiveSphereSticks) {
  ImpactJob job;
  job.normal = NormalModel::kJkr;
  job.friction = FrictionModel::kNone;
  job.body = {BodyShape::kSolidSphere, 4e-6, 2e-3};
  job.contact.reduced_modulus_pa = 1e6;
  job.contact.adhesion_j_per_m2 = 0.1;
  job.gravity_m_s2 = 0;
  const double lost = 7.09 * std::cbrt(1e-5 * 1e-12 / 1e12);
  const double sticking = std::sqrt(2 * lost / job.body.mass_kg);
  job.initial.vn_m_s = -0.99 * sticking;
  const ImpactResult slow = sim::contact::simulate_impact(job);
  EXPECT_FALSE(slow.separated);
  job.initial.vn_m_s = -1.01 * sticking;
  const ImpactResult fast = sim::contact::simulate_impact(job);
  EXPECT_TRUE(fast.separated);
  EXPECT_NEAR(fast.restitution, std::sqrt(1 - 1 / (1.01 * 1.01)), 0.01);
  // That the surface pulls is this law's nature, not a fault.
  EXPECT_TRUE(fast.warnings.empty());
  EXPECT_LT(fast.separation_force_n, 0);
}

// A ball that its weight presses into a damped surface comes to rest there without turning.
TEST(NormalLaws, AHeavyBallSinksToRest) {
  ImpactJob job = sim::job::wood_sound_job();
  job.normal = NormalModel::kHuntCrossley;
  job.friction = FrictionModel::kCoulomb;
  job.contact.poisson = 0;
  job.contact.stiffness = 800;
  job.contact.damping_s_per_m = 27;
  job.body.mass_kg = 2.4;
  job.surface_angle_deg = -5;
  job.initial.vn_m_s = -0.05;
  job.initial.vt_m_s = 0.1;
  const ImpactResult result = sim::contact::simulate_impact(job);
  EXPECT_FALSE(result.separated);
  // It carries its weight.
  const double depth = -result.final.qn_m, load = 800 * std::pow(depth, 1.5);
  EXPECT_NEAR(load, 2.4 * 9.81 * std::cos(5 * kRadPerDeg), 1e-6);
}

// It sinks for minutes, and stick and slip follow each other until they are rounding.
TEST(NormalLaws, ABallThatCreepsIntoTheSurfaceIsHeld) {
  ImpactJob job;
  job.normal = NormalModel::kHuntCrossley;
  job.body = {BodyShape::kSolidSphere, 0.0221208, 2 * 0.0869294};
  job.contact.stiffness = 4.35086;
  job.contact.damping_s_per_m = 41.037;
  job.contact.poisson = 0.40151;
  job.contact.friction_kinetic = 0.612629;
  job.surface_angle_deg = -28.1414;
  job.initial.vt_m_s = -0.103875;
  job.initial.vn_m_s = -0.048241;
  job.initial.omega_rad_s = 0.205734;
  for (const FrictionModel friction : {FrictionModel::kMindlin, FrictionModel::kCoulomb}) {
    job.friction = friction;
    const ImpactResult result = sim::contact::simulate_impact(job);
    EXPECT_FALSE(result.separated);
    // The ball goes down the slope meanwhile.
    EXPECT_NEAR(result.energy.residual_j, 0,
                1e-9 * result.energy.kinetic_start_j + 1e-12 * result.energy.gravity_j);
    // Spring and damper carry the weight; it is still a little above where the spring alone would.
    const double weight = 0.0221208 * 9.81 * std::cos(28.1414 * kRadPerDeg);
    EXPECT_NEAR(result.max_force_n, weight, 1e-3 * weight);
    EXPECT_LT(result.max_deflection_m, std::pow(weight / 4.35086, 2.0 / 3) * (1 + 1e-9));
    EXPECT_GT(result.max_deflection_m, 0.1);
  }
}

TEST(NormalLaws, FrictionThatFadesLiesBetweenItsLimits) {
  ImpactJob job = sim::job::racket_job();
  job.gravity_m_s2 = 0;
  job.initial.vt_m_s = 20;
  const auto ratio = [&](double speed) {
    job.friction = FrictionModel::kSpeedDependent;
    job.contact.friction_kinetic = 0.1;
    job.contact.friction_static = 0.3;
    job.contact.friction_speed_m_s = speed;
    const ImpactResult r = sim::contact::simulate_impact(job);
    return -r.impulse_t_n_s / r.impulse_n_n_s;
  };
  EXPECT_NEAR(ratio(1e-3), 0.1, 1e-9);
  EXPECT_NEAR(ratio(1e9), 0.3, 1e-6);
  const double middle = ratio(20);
  EXPECT_GT(middle, 0.1 + 0.2 * std::exp(-1.0));
  EXPECT_LT(middle, 0.3);
}

TEST(NormalLaws, BeyondItsRangeEachSaysSo) {
  for (const Law& law : kLaws) {
    ImpactJob job = read(job_of(law.name, law.constants)).impact;
    job.initial.vn_m_s = -400;
    job.initial.vt_m_s = 0;
    const ImpactResult fast = sim::contact::simulate_impact(job);
    ASSERT_FALSE(fast.warnings.empty()) << law.name;
    EXPECT_NE(fast.warnings[0].find("outside the normal law's range"), std::string::npos)
        << law.name;
  }
}

}  // namespace
}  // namespace impactdic
