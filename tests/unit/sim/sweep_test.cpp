// Sweeps: every shot is the impact that a job of its own would give.
#include "sim/sweep/sweep.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <impactdic/models/sweep.h>
#include <impactdic/simulate.h>
#include <impactdic/units.h>

#include <cmath>
#include <filesystem>

#include "host/report/job/sweep_files.h"
#include "sim/job/source_jobs.h"
#include "sim/sweep/sweep_job.h"
#include "tests/support/job_text.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

const char* const kRacketSweep = R"(
normal = "linear_spring_damper"
friction = "coulomb"
[body]
shape = "hollow_sphere"
mass_kg = 0.0567
diameter_m = 0.067
[contact]
stiffness_n_per_m = 13385.0
damping_n_s_per_m = 5.36
[sweep]
speed_m_s = [2.0, 0.0, 4.0]
friction_kinetic = {from = 0.0, to = 0.4, count = 3}
drop_angle_deg = [15.0]
)";

SweepRequest read(const std::string& text) {
  return sim::sweep::read_sweep_job(testing::write_job(text));
}

std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const InvalidArgument& error) {
    return error.line();
  }
  return "accepted";
}

TEST(Sweep, ShotsAreThoseOfTheirOwnJobsToTheBit) {
  SweepRequest request;
  request.model = sim::job::wood_sound_job();
  request.axes = {{SweepAxis::kSpeed, {1, 3}},
                  {SweepAxis::kIncidence, {10, 50}},
                  {SweepAxis::kSpin, {-20, 0, 35}}};
  const SweepResult result = sweep(request);
  ASSERT_EQ(result.shots.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) {
    const std::vector<double> values = request.values_of(i);
    ImpactJob job = sim::job::wood_sound_job();
    job.initial.vt_m_s = values[0] * std::sin(values[1] * kRadPerDeg);
    job.initial.vn_m_s = -values[0] * std::cos(values[1] * kRadPerDeg);
    job.initial.omega_rad_s = values[2];
    const ImpactResult own = simulate(SimulateRequest{.impact = job});
    // The direction is taken apart and put together: last digits differ from a job by hand.
    EXPECT_NEAR(result.shots[i].after.vt_m_s, own.final.vt_m_s, 1e-12) << i;
    EXPECT_NEAR(result.shots[i].after.omega_rad_s, own.final.omega_rad_s, 1e-10) << i;
    const auto exact = std::get<ImpactJob>(request.shot(i));
    EXPECT_EQ(result.shots[i].restitution, simulate(SimulateRequest{.impact = exact}).restitution);
    EXPECT_EQ(result.shots[i].before.vt_m_s, exact.initial.vt_m_s);
  }
  // The first axis varies slowest.
  EXPECT_EQ(request.values_of(0), (std::vector<double>{1, 10, -20}));
  EXPECT_EQ(request.values_of(11), (std::vector<double>{3, 50, 35}));
  EXPECT_EQ(request.values_of(7), (std::vector<double>{3, 10, 0}));
}

TEST(Sweep, DoesNotDependOnThreads) {
  SweepRequest request = read(kRacketSweep);
  request.threads = 1;
  const SweepResult one = sweep(request);
  request.threads = 7;
  const SweepResult many = sweep(request);
  ASSERT_EQ(one.shots.size(), many.shots.size());
  for (std::size_t i = 0; i < one.shots.size(); ++i) {
    EXPECT_EQ(one.shots[i].status, many.shots[i].status);
    if (one.shots[i].status != SweepStatus::kSeparated) continue;
    EXPECT_EQ(one.shots[i].after.vt_m_s, many.shots[i].after.vt_m_s);
    EXPECT_EQ(one.shots[i].lost, many.shots[i].lost);
  }
}

TEST(Sweep, AnUndampedHertzianReboundMapDoesNotKnowTheSpeed) {
  SweepRequest request;
  ImpactJob job = sim::job::wood_sound_job();
  job.contact.damping_n_s_per_m = 0;
  job.gravity_m_s2 = 0;
  request.model = job;
  request.axes = {{SweepAxis::kIncidence, {15, 45, 80}}, {SweepAxis::kSpeed, {0.5, 5}}};
  const SweepResult result = sweep(request);
  for (std::size_t i = 0; i < 3; ++i) {
    const SweepShot &slow = result.shots[2 * i], &fast = result.shots[2 * i + 1];
    EXPECT_NEAR(slow.tangential_restitution, fast.tangential_restitution, 1e-7);
    EXPECT_NEAR(slow.friction, fast.friction, 1e-8);
    EXPECT_NEAR(slow.restitution, 1, 1e-9);
  }
  // Gross slip throughout at 80 degrees: friction is that of Coulomb, and nothing springs back.
  EXPECT_EQ(result.shots[5].phases, "gross_slip");
  EXPECT_NEAR(result.shots[5].friction, 0.54, 1e-6);
  EXPECT_LT(result.shots[5].tangential_restitution, 0);
  EXPECT_GT(result.shots[1].tangential_restitution, 0);
}

TEST(Sweep, DropsFallVerticallyAndSpinRatiosAreOfTheSpeed) {
  SweepRequest request;
  request.model = sim::job::racket_job();
  request.axes = {
      {SweepAxis::kSpinRatio, {0.5}}, {SweepAxis::kDropAngle, {15, -30}}, {SweepAxis::kSpeed, {2}}};
  request.validate();
  const auto job = std::get<ImpactJob>(request.shot(0));
  EXPECT_EQ(job.surface_angle_deg, 15);
  EXPECT_NEAR(job.initial.vt_m_s, -2 * std::sin(15 * kRadPerDeg), 1e-15);
  EXPECT_NEAR(job.initial.vn_m_s, -2 * std::cos(15 * kRadPerDeg), 1e-15);
  EXPECT_NEAR(job.initial.omega_rad_s, 0.5 * 2 / 0.0335, 1e-12);
  EXPECT_GT(std::get<ImpactJob>(request.shot(1)).initial.vt_m_s, 0);
}

TEST(Sweep, AShotThatCannotBeHasAReasonAndNoFigures) {
  const SweepRequest request = read(kRacketSweep);
  const SweepResult result = sweep(request);
  ASSERT_EQ(result.shots.size(), 9u);
  EXPECT_EQ(result.shots[0].status, SweepStatus::kSeparated);
  EXPECT_EQ(result.shots[3].status, SweepStatus::kFailed);
  EXPECT_NE(result.shots[3].reason.find("does not approach"), std::string::npos);
  EXPECT_TRUE(std::isnan(result.shots[3].after.vt_m_s));
  const auto warnings = report::sweep_warnings(result);
  ASSERT_FALSE(warnings.empty());
  EXPECT_EQ(warnings.back(), "3 of 9 shots failed; sweep.csv says why");
  testing::ScratchFolder scratch;
  std::filesystem::create_directories(scratch / "out");
  report::write_sweep(scratch / "out", request, result);
  const std::string table = testing::read_text(scratch / "out" / "sweep.csv");
  EXPECT_NE(table.find("\n0,0.2,15,failed,,,,,"), std::string::npos) << table;
  EXPECT_NE(table.find("\n2,0.2,15,ok,-0.51763"), std::string::npos);
}

TEST(Sweep, RodsAndFormulasAreSweptToo) {
  SweepRequest request;
  RodModel rod;
  rod.rod = rigid_rod_preset();
  rod.rod.vn_m_s = -1;
  request.model = rod;
  request.axes = {{SweepAxis::kRodAngle, {17, 45}}, {SweepAxis::kSpeed, {1, 2.487}}};
  SweepResult result = sweep(request);
  EXPECT_NEAR(result.shots[1].restitution, 0.290, 5e-4);  // physics of chapter 5, rigid rod
  EXPECT_NEAR(result.shots[3].restitution, 0.270, 5e-4);
  EXPECT_NEAR(result.shots[3].after.omega_rad_s, -16.5, 0.05);
  EXPECT_GT(result.shots[1].dent_m, result.shots[0].dent_m);
  ReboundJob walton;
  walton.body = {BodyShape::kSolidSphere, 0.1, 0.06};
  walton.friction_kinetic = 0.1;
  walton.initial.vt_m_s = 1, walton.initial.vn_m_s = -1;
  request.model = walton;
  request.axes = {{SweepAxis::kRestitution, {0.5, 0.9}}, {SweepAxis::kIncidence, {80}}};
  result = sweep(request);
  EXPECT_EQ(result.shots[0].restitution, 0.5);
  // Gross slip (Walton 1993): the impulse ratio is the coefficient.
  EXPECT_NEAR(result.shots[1].friction, 0.1, 1e-12);
  EXPECT_TRUE(std::isnan(result.shots[0].contact_s));
}

TEST(Sweep, AJobReadsBackToTheSameAndAxesStandAsInTheFile) {
  const SweepRequest request = read(kRacketSweep);
  ASSERT_EQ(request.axes.size(), 3u);
  EXPECT_EQ(request.axes[0].axis, SweepAxis::kSpeed);
  EXPECT_EQ(request.axes[1].axis, SweepAxis::kFrictionKinetic);
  EXPECT_EQ(request.axes[1].values, (std::vector<double>{0, 0.2, 0.4}));
  const std::string text = sim::sweep::to_toml(request);
  EXPECT_EQ(sim::sweep::to_toml(read(text)), text);
  EXPECT_TRUE(sim::sweep::is_sweep_job(testing::write_job(text)));
}

TEST(Sweep, ReadyJobsAreSweeps) {
  int count = 0;
  const std::filesystem::path jobs = std::filesystem::path(IMPACTDIC_SOURCE_DIR) / "sim/jobs";
  for (const auto& entry : std::filesystem::directory_iterator(jobs)) {
    if (!entry.path().filename().string().starts_with("sweep_")) continue;
    ++count;
    const SweepRequest request = sim::sweep::read_sweep_job(entry.path());
    // The slowest and the fastest shot of each.
    EXPECT_EQ(sim::sweep::run_shot(request.shot(0)).status, SweepStatus::kSeparated);
    EXPECT_EQ(sim::sweep::run_shot(request.shot(request.size() - 1)).status,
              SweepStatus::kSeparated)
        << entry.path();
  }
  EXPECT_GE(count, 3);
}

TEST(Sweep, WhatIsWrongIsNamed) {
  using testing::replaced;
  const std::string text = kRacketSweep;
  EXPECT_NE(refusal(replaced(text, "speed_m_s", "speed")).find("sweep.speed"), std::string::npos);
  EXPECT_NE(refusal(replaced(text, "count = 3", "count = 1")).find("sweep.friction_kinetic.count"),
            std::string::npos);
  EXPECT_NE(refusal(replaced(text, "[15.0]", "[]")).find("has no values"), std::string::npos);
  EXPECT_NE(refusal(replaced(text, "[15.0]", "15.0")).find("must be a list of numbers"),
            std::string::npos);
  EXPECT_NE(refusal(replaced(text, "drop_angle_deg", "poisson")).find("poisson"),
            std::string::npos);
  EXPECT_NE(
      refusal(replaced(text, "[15.0]", "[15.0]\nincidence_deg = [1.0]")).find("says it already"),
      std::string::npos);
  EXPECT_NE(refusal(replaced(text, "mass_kg = 0.0567", "mass_kg = -1.0")).find("body.mass_kg"),
            std::string::npos);
  EXPECT_NE(refusal(text + "[solver]\nstep = 1\n").find("solver.step"), std::string::npos);
  SweepRequest many;
  many.model = sim::job::racket_job();
  many.axes = {{SweepAxis::kSpeed, std::vector<double>(2000, 1)},
               {SweepAxis::kIncidence, std::vector<double>(2000, 1)}};
  EXPECT_THROW(many.validate(), InvalidArgument);
}

}  // namespace
}  // namespace impactdic
