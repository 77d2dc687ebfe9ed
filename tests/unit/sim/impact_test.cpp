// The plane impact models: the built-in table, accuracy, switches, energy audit, independence of
// the way they are run.
#include "sim/contact/impact.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sim/job/source_jobs.h"
#include "sim/verify/verify_cases.h"
#include "sim/verify/verify_rod.h"

namespace impactdic {
namespace {

const ContactPhase* find_phase(const ImpactResult& result, const std::string& name) {
  for (const ContactPhase& phase : result.phases) {
    if (phase.name == name) return &phase;
  }
  return nullptr;
}

TEST(Verify, EveryRowOfTheTablePasses) {
  for (const sim::verify::VerifyOutcome& outcome :
       sim::verify::run_cases(sim::verify::impact_cases())) {
    EXPECT_TRUE(outcome.passed) << outcome.row.group << ", " << outcome.row.name << ": "
                                << outcome.computed << ", expected " << outcome.row.expected
                                << " +- " << outcome.row.tolerance << " " << outcome.error;
  }
}

TEST(Verify, EveryRowSaysWhereItsFigureComesFrom) {
  std::vector<sim::verify::VerifyCase> cases = sim::verify::impact_cases();
  for (sim::verify::VerifyCase& row : sim::verify::rod_cases()) cases.push_back(std::move(row));
  for (const sim::verify::VerifyCase& row : cases) {
    const bool known =
        std::any_of(std::begin(sim::verify::kProvenances), std::end(sim::verify::kProvenances),
                    [&](const char* provenance) { return row.source.starts_with(provenance); });
    EXPECT_TRUE(known) << row.group << ", " << row.name << ": " << row.source;
  }
}

TEST(Verify, ARowThatIsWrongFails) {
  const auto outcomes = sim::verify::run_cases(
      {{"g", "off", "s", 1, 0.1, [] { return 1.2; }},
       {"g", "nan", "s", 1, 0.1, [] { return std::nan(""); }},
       {"g", "throws", "s", 1, 0.1, []() -> double { throw InvalidArgument("bad", "key"); }}});
  for (const sim::verify::VerifyOutcome& outcome : outcomes)
    EXPECT_FALSE(outcome.passed) << outcome.row.name;
  EXPECT_EQ(outcomes[2].error, "bad");
}

// Integrals at the default tolerance against a run at 1e-13.
TEST(Impact, IntegralsAgreeWithAStricterRun) {
  for (ImpactJob job :
       {sim::job::racket_job(), sim::job::wood_published_job(), sim::job::wood_sound_job()}) {
    const ImpactResult usual = sim::contact::simulate_impact(job);
    job.solver.relative_tolerance = 1e-13;
    const ImpactResult strict = sim::contact::simulate_impact(job);
    const double speed = std::hypot(job.initial.vt_m_s, job.initial.vn_m_s);
    EXPECT_NEAR(usual.final.vt_m_s, strict.final.vt_m_s, 1e-9 * speed);
    EXPECT_NEAR(usual.final.vn_m_s, strict.final.vn_m_s, 1e-9 * speed);
    EXPECT_NEAR(usual.final.omega_rad_s, strict.final.omega_rad_s,
                1e-9 * speed / job.body.radius_m());
    EXPECT_NEAR(usual.max_deflection_m / strict.max_deflection_m, 1, 1e-9);
    EXPECT_NEAR(usual.peak_force_n / strict.peak_force_n, 1, 1e-9);
    EXPECT_NEAR(usual.contact_s, strict.contact_s, 1e-10);
  }
}

// The same law written out plainly: fixed steps of the classical Runge-Kutta method, sticking found
// between steps by bisection of nothing - just tiny steps.
TEST(Impact, PublishedRuleAgreesWithAPlainIntegration) {
  const ImpactJob job = sim::job::wood_published_job();
  const double m = job.body.mass_kg, radius = job.body.radius_m(), inertia = job.body.inertia();
  const double k = job.contact.stiffness, b = job.contact.damping_n_s_per_m;
  const double slope = 20 * 3.14159265358979323846 / 180;
  const double scale = 0.57 / std::hypot(0.57, 1.69);
  double qn = 0, vt = 0.57, vn = -1.69, omega = 0, critical = 0, t = 0;
  int stage = 0;  // sliding, sticking, sliding
  const double dt = 2e-9;
  while (qn <= 0) {
    const double spring = k * std::pow(std::max(-qn, 0.0), 1.5);
    const double tip = vt + radius * omega;
    if (stage == 0 && tip <= 0) {
      stage = 1;
      critical = spring;
    }
    if (stage == 1 && spring < critical) stage = 2;
    const double direction = stage == 1 ? 1.0 : (tip > 0) - (tip < 0);
    const double friction = -(stage == 1 ? 0.74 : 0.54) * scale * spring * direction;
    const double normal = spring + (vn < 0 ? -b * vn : 0.0);
    vn += dt * (normal / m - 9.81 * std::cos(slope));  // symplectic Euler: order dt
    vt += dt * (friction / m - 9.81 * std::sin(slope));
    omega += dt * radius * friction / inertia;
    qn += dt * vn;
    t += dt;
  }
  const ImpactResult result = sim::contact::simulate_impact(job);
  EXPECT_NEAR(result.final.vt_m_s, vt, 2e-5);
  EXPECT_NEAR(result.final.vn_m_s, vn, 2e-5);
  EXPECT_NEAR(result.final.omega_rad_s, omega, 1e-3);
  EXPECT_NEAR(result.contact_s, t, 1e-8);
}

// Maw, Barber and Fawcett by following many springs one by one.
double discrete_springs_vt(const ImpactJob& job, int springs, int steps) {
  const double m = job.body.mass_kg, radius = job.body.radius_m(), inertia = job.body.inertia();
  const double k = job.contact.stiffness, nu = job.contact.poisson;
  const double ratio = 2 * (1 - nu) / (2 - nu), modulus = 0.75 * k / std::sqrt(radius);
  const double alpha = job.contact.friction_kinetic / ratio;
  const double depth = 1.02 * std::pow(1.25 * m * std::pow(job.initial.vn_m_s, 2) / k, 0.4);
  const double dx = std::sqrt(radius * depth) / springs;
  const double dt = 2.94328 * depth / -job.initial.vn_m_s / steps;
  std::vector<double> u(springs, 0.0);
  double delta = 0, rate = -job.initial.vn_m_s, vt = job.initial.vt_m_s, omega = 0, force = 0;
  do {
    const auto kick = [&] {
      rate -= 0.5 * dt * k * std::pow(std::max(delta, 0.0), 1.5) / m;
      vt += 0.5 * dt * force / m;
      omega += 0.5 * dt * radius * force / inertia;
    };
    kick();
    delta += dt * rate;
    const double way = dt * (vt + radius * omega);
    force = 0;
    for (int i = 0; i < springs; ++i) {
      const double x = (i + 0.5) * dx;
      const double bound = std::max(alpha * (delta - x * x / radius), 0.0);
      u[i] = std::clamp(bound > 0 ? u[i] + way : 0.0, -bound, bound);
      force -= 2 * ratio * modulus * u[i] * dx;
    }
    kick();
  } while (delta > 0);
  return vt;
}

TEST(MawBarberFawcett, IsTheLimitOfManySprings) {
  for (const double vt : {0.3, 0.57, 1.2, 2.5}) {
    ImpactJob job = sim::job::wood_sound_job();
    job.gravity_m_s2 = 0;
    job.contact.damping_n_s_per_m = 0;
    job.contact.poisson = 0.3;
    job.initial.vt_m_s = vt;
    const double exact = sim::contact::simulate_impact(job).final.vt_m_s;
    const double coarse = std::abs(discrete_springs_vt(job, 400, 2000) - exact);
    const double fine = std::abs(discrete_springs_vt(job, 1600, 8000) - exact);
    EXPECT_LT(fine, 1e-4 * vt + 2e-5) << vt;
    EXPECT_LT(fine, 0.5 * coarse + 1e-6) << vt;  // it converges to ours
  }
}

TEST(MawBarberFawcett, EnergyIsStoredAndNeverCreated) {
  const ImpactResult result =
      sim::contact::simulate_impact(sim::job::wood_sound_job(), {.rate_hz = 2e5});
  double largest = 0, slip = 0;
  for (const TrajectoryPoint& point : result.trajectory) {
    EXPECT_NEAR(point.energy.residual_j, 0, 1e-8 * point.energy.kinetic_start_j);
    EXPECT_GE(point.energy.slip_j, slip - 1e-12);
    slip = point.energy.slip_j;
    largest = std::max(largest, point.energy.tangential_elastic_j);
  }
  EXPECT_GT(largest, 1e-3);
  EXPECT_NEAR(result.energy.tangential_elastic_j, 0, 1e-12);
  EXPECT_TRUE(result.warnings.empty());
}

TEST(EnergyAudit, PublishedStickingRuleIsFlaggedAndSoundModelsAreNot) {
  const ImpactResult published = sim::contact::simulate_impact(sim::job::wood_published_job());
  ASSERT_EQ(published.warnings.size(), 1u);
  EXPECT_NE(published.warnings[0].find("sticking"), std::string::npos);
  const ContactPhase* sticking = find_phase(published, "sticking");
  ASSERT_NE(sticking, nullptr);
  EXPECT_LT(sticking->slip_j, -5e-3);  // joules fed in
  ImpactJob sound = sim::job::wood_published_job();
  sound.preset = ModelPreset::kSound;
  EXPECT_TRUE(sim::contact::simulate_impact(sound).warnings.empty());
  EXPECT_TRUE(sim::contact::simulate_impact(sim::job::racket_job()).warnings.empty());
  ImpactJob pulled = sim::job::racket_job();
  pulled.contact.restitution_damping = RestitutionDamping::kToZeroDeflection;
  ASSERT_EQ(sim::contact::simulate_impact(pulled).warnings.size(), 1u);
  EXPECT_NE(sim::contact::simulate_impact(pulled).warnings[0].find("pulls"), std::string::npos);
}

TEST(Flight, GapDelaysTheSameImpact) {
  ImpactJob job = sim::job::racket_job();
  job.surface_angle_deg = 0;
  const ImpactResult direct = sim::contact::simulate_impact(job);
  ImpactJob dropped = job;
  const double height = 0.05;
  dropped.initial.gap_m = height;
  dropped.initial.vn_m_s = -std::sqrt(std::pow(job.initial.vn_m_s, 2) - 2 * 9.81 * height);
  const ImpactResult later = sim::contact::simulate_impact(dropped);
  EXPECT_NEAR(later.restitution, direct.restitution, 1e-10);
  EXPECT_NEAR(later.contact_s, direct.contact_s, 1e-12);
  EXPECT_STREQ(later.phases.front().name, "flight");
  EXPECT_NEAR(later.energy.residual_j, 0, 1e-9 * later.energy.kinetic_start_j);
}

TEST(Flight, BallBouncesAgain) {
  ImpactJob job = sim::job::racket_job();
  job.surface_angle_deg = 0;
  job.initial.vt_m_s = 0;
  job.solver.contacts = 3;
  const ImpactResult result = sim::contact::simulate_impact(job);
  int compressions = 0;
  for (const ContactPhase& phase : result.phases)
    compressions += phase.name == std::string("compression");
  EXPECT_EQ(compressions, 3);
  // Gravity changes e a little from one bounce to the next.
  EXPECT_NEAR(result.final.vn_m_s / -job.initial.vn_m_s, std::pow(result.restitution, 3), 0.01);
  EXPECT_NEAR(result.energy.residual_j, 0, 1e-9 * result.energy.kinetic_start_j);
}

TEST(Flight, BallThatCannotLeaveComesToRest) {
  ImpactJob job = sim::job::racket_job();
  job.surface_angle_deg = 0;
  job.initial.vn_m_s = -0.01;  // the static deflection is deeper than the bounce
  job.contact.damping_n_s_per_m = 40;
  const ImpactResult result = sim::contact::simulate_impact(job);
  EXPECT_FALSE(result.separated);
  EXPECT_TRUE(std::isnan(result.restitution));
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_NE(result.warnings.back().find("rest"), std::string::npos);
}

TEST(Recording, DoesNotChangeTheResultAndMeetsTheTimes) {
  const ImpactJob job = sim::job::wood_published_job();
  const ImpactResult bare = sim::contact::simulate_impact(job);
  const std::vector<double> times = {-1e-3, 0, 1e-3, 2.5e-3, bare.contact_s + 1e-3};
  const ImpactResult sampled = sim::contact::simulate_impact(job, {.times_s = times});
  EXPECT_EQ(sampled.final.vt_m_s, bare.final.vt_m_s);
  EXPECT_EQ(sampled.contact_s, bare.contact_s);
  ASSERT_EQ(sampled.trajectory.size(), times.size());
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(sampled.trajectory[i].time_s, times[i]);
  // Free flight under gravity before and after.
  EXPECT_NEAR(sampled.trajectory[0].state.vn_m_s, -1.69 + 1e-3 * 9.81 * std::cos(20 * 0.0174532925),
              1e-9);
  EXPECT_NEAR(sampled.trajectory[4].state.qn_m,
              1e-3 * bare.final.vn_m_s - 0.5e-6 * 9.81 * std::cos(20 * 0.0174532925), 1e-9);
  EXPECT_EQ(sampled.trajectory[4].normal_force_n, 0);
}

TEST(Recording, PointsSatisfyTheEquationsOfMotion) {
  const ImpactJob job = sim::job::wood_sound_job();
  const double h = 1e-6;
  const auto path = sim::contact::simulate_impact(job, {.rate_hz = 1 / h}).trajectory;
  for (std::size_t i = 500; i + 2 < path.size(); i += 500) {
    const double slope = (path[i + 1].state.vt_m_s - path[i - 1].state.vt_m_s) / (2 * h);
    const double expected =
        path[i].tangential_force_n / job.body.mass_kg + 9.81 * std::sin(20 * 0.017453292519943295);
    EXPECT_NEAR(slope, expected, 1e-3 * std::abs(expected) + 0.05) << path[i].time_s;
    EXPECT_NEAR((path[i + 1].state.qn_m - path[i - 1].state.qn_m) / (2 * h), path[i].state.vn_m_s,
                1e-6);
  }
}

TEST(BodyShapes, GivenInertiaStandsForAShape) {
  ImpactJob job = sim::job::wood_published_job();
  const ImpactResult solid = sim::contact::simulate_impact(job);
  job.body.inertia_kg_m2 = 0.4 * job.body.mass_kg * std::pow(job.body.radius_m(), 2);
  job.body.shape = BodyShape::kOther;
  EXPECT_NEAR(sim::contact::simulate_impact(job).final.omega_rad_s, solid.final.omega_rad_s, 1e-9);
}

TEST(BodyShapes, UprightRodFallsStraightAndATiltedOneTurns) {
  ImpactJob job;
  job.normal = NormalModel::kHertzDamper;
  job.friction = FrictionModel::kCoulomb;
  job.body = {BodyShape::kRod, 0.5784, 0.0127, 0.3};
  job.contact.stiffness = 1e9;
  job.contact.friction_kinetic = 0.3;
  job.gravity_m_s2 = 0;
  job.initial.vn_m_s = -1;
  job.initial.angle_deg = 90;
  const ImpactResult upright = sim::contact::simulate_impact(job);
  EXPECT_NEAR(upright.restitution, 1, 1e-9);
  EXPECT_NEAR(upright.final.omega_rad_s, 0, 1e-6);
  job.initial.angle_deg = 45;
  const ImpactResult tilted = sim::contact::simulate_impact(job);
  EXPECT_NEAR(tilted.energy.residual_j, 0, 1e-9 * tilted.energy.kinetic_start_j);
  // The surface pushes the end that lies left of the centre: clockwise.
  EXPECT_LT(tilted.final.omega_rad_s, -1);
}

// 30 x 20 x 15 integrations under 2 s (the target, on one core of the reference machine). Here the
// bound is on the work, which does not depend on the machine or its load.
TEST(Speed, AnImpactTakesFewEvaluations) {
  EXPECT_LT(sim::contact::simulate_impact(sim::job::racket_job()).evaluations, 1000);
  EXPECT_LT(sim::contact::simulate_impact(sim::job::wood_published_job()).evaluations, 1400);
  EXPECT_LT(sim::contact::simulate_impact(sim::job::wood_sound_job()).evaluations, 2500);
}

TEST(Jobs, ImpossibleValuesAreNamed) {
  const auto rejected = [](auto change) -> std::string {
    ImpactJob job = sim::job::wood_published_job();
    change(job);
    try {
      sim::contact::simulate_impact(job);
    } catch (const InvalidArgument& error) {
      return error.where();
    }
    return "accepted";
  };
  EXPECT_EQ(rejected([](ImpactJob& j) { j.body.mass_kg = -1; }), "body.mass_kg");
  EXPECT_EQ(rejected([](ImpactJob& j) { j.body.diameter_m = std::nan(""); }), "body.diameter_m");
  EXPECT_EQ(rejected([](ImpactJob& j) { j.contact.stiffness = 0; }),
            "contact.stiffness_n_per_m1p5");
  EXPECT_EQ(rejected([](ImpactJob& j) { j.contact.damping_n_s_per_m = -1; }),
            "contact.damping_n_s_per_m");
  EXPECT_EQ(rejected([](ImpactJob& j) { j.contact.friction_static = 0.1; }),
            "contact.friction_static");
  EXPECT_EQ(rejected([](ImpactJob& j) { j.initial.vn_m_s = 1; }), "initial.vn_m_s");
  EXPECT_EQ(rejected([](ImpactJob& j) { j.initial.vn_m_s = 0; }), "initial.vn_m_s");
  EXPECT_EQ(rejected([](ImpactJob& j) { j.initial.vt_m_s = INFINITY; }), "initial.vt_m_s");
  EXPECT_EQ(rejected([](ImpactJob& j) {
              j.initial.gap_m = 1;
              j.gravity_m_s2 = 0;
              j.initial.vn_m_s = 1;
            }),
            "initial.gap_m");
  EXPECT_EQ(rejected([](ImpactJob& j) { j.solver.relative_tolerance = 0; }),
            "solver.relative_tolerance");
  EXPECT_EQ(rejected([](ImpactJob& j) {
              j.friction = FrictionModel::kMawBarberFawcett;
              j.normal = NormalModel::kLinearSpringDamper;
            }),
            "normal");
}

}  // namespace
}  // namespace impactdic
