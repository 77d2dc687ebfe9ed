// Job files, result files and poses of the impact models.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "sim/contact/closed_form.h"
#include "sim/contact/impact.h"
#include "sim/contact/motion.h"
#include "sim/job/job_toml.h"
#include "sim/job/result_files.h"
#include "sim/job/source_jobs.h"
#include "tests/support/job_text.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

namespace fs = std::filesystem;

const std::string kGood = R"(normal = "hertz_damper"
friction = "three_phase"
preset = "published"
[body]
shape = "solid_sphere"
mass_kg = 0.14566
diameter_m = 0.06325
[contact]
stiffness_n_per_m1p5 = 875000
damping_n_s_per_m = 9.5
friction_kinetic = 0.54
friction_static = 0.74
[surface]
angle_deg = 20
[initial]
vt_m_s = 0.57
vn_m_s = -1.69
)";

using testing::error_of;
using testing::write_job;

std::string replaced(const std::string& from, const std::string& to) {
  return testing::replaced(kGood, from, to);
}

TEST(JobFile, ReadsAJob) {
  const ImpactJob job = sim::job::read_simulate_job(write_job(kGood)).impact;
  EXPECT_EQ(sim::contact::simulate_impact(job).final.vt_m_s,
            sim::contact::simulate_impact(sim::job::wood_published_job()).final.vt_m_s);
}

TEST(JobFile, ResolvedJobReadsBackToTheSame) {
  for (const ImpactJob& impact :
       {sim::job::racket_job(), sim::job::wood_published_job(), sim::job::wood_sound_job()}) {
    SimulateRequest job{impact, 12345.678};
    const std::string text = sim::job::to_toml(job);
    const SimulateRequest again = sim::job::read_simulate_job(write_job(text));
    EXPECT_EQ(sim::job::to_toml(again), text);
    EXPECT_EQ(sim::contact::simulate_impact(again.impact).final.vt_m_s,
              sim::contact::simulate_impact(impact).final.vt_m_s);
  }
}

TEST(JobFile, BadJobsNameFileAndKey) {
  struct Row {
    const char *from, *to, *key, *says;
  };
  for (const Row& row :
       {Row{"mass_kg = 0.14566", "mass_kg = 0.14566\nmas = 1", "body.mas", "unknown key"},
        Row{"mass_kg", "mass", "body.mass_kg", "carries its unit"},
        Row{"diameter_m = 0.06325", "diameter_m = 0.06325\ndiameter_mm = 63", "body.diameter_mm",
            "did you mean diameter_m"},
        Row{"mass_kg = 0.14566", "mass_kg = -1.0", "body.mass_kg", "positive"},
        Row{"mass_kg = 0.14566", "mass_kg = nan", "body.mass_kg", "finite"},
        Row{"mass_kg = 0.14566", "mass_kg = \"heavy\"", "body.mass_kg", "number"},
        Row{"stiffness_n_per_m1p5", "stiffness_n_per_m", "contact.stiffness_n_per_m1p5", "missing"},
        Row{"friction_static = 0.74", "", "contact.friction_static", "missing"},
        Row{"\"three_phase\"", "\"coulomb\"", "contact.friction_static", "three_phase"},
        Row{"\"three_phase\"", "\"glue\"", "friction", "not known"},
        Row{"preset = \"published\"", "preset = \"mine\"", "preset", "not known"},
        Row{"normal = \"hertz_damper\"\n", "", "normal", "missing"},
        Row{"vn_m_s = -1.69", "", "initial.vn_m_s", "missing"},
        Row{"[surface]", "[flat]", "flat", "unknown key"}}) {
    const std::string line = error_of(replaced(row.from, row.to));
    EXPECT_NE(line.find("/job.toml: " + std::string(row.key)), std::string::npos) << line;
    EXPECT_NE(line.find(row.says), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
}

TEST(JobFile, UnreadableFilesAreFileErrors) {
  EXPECT_THROW(sim::job::read_simulate_job("/nonexistent/job.toml"), FileError);
  EXPECT_THROW(sim::job::read_simulate_job(write_job("normal = ")), FormatError);
}

TEST(JobFile, ReadyJobsRun) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(IMPACTDIC_SOURCE_DIR) / "sim/jobs")) {
    if (entry.path().extension() != ".toml") continue;
    std::ifstream stream(entry.path());
    std::stringstream text;
    text << stream.rdbuf();
    // Rods, sweeps and comparisons are other kinds of job.
    if (text.str().find("model = ") != std::string::npos) continue;
    if (entry.path().filename().string().starts_with("sweep_")) continue;
    if (entry.path().filename().string().starts_with("compare_")) continue;
    ++count;
    const ImpactResult result =
        sim::contact::simulate_impact(sim::job::read_simulate_job(entry.path()).impact);
    EXPECT_TRUE(result.separated) << entry.path();
    EXPECT_GT(result.restitution, 0.7) << entry.path();
  }
  EXPECT_GE(count, 17);
}

TEST(ResultFiles, TrajectoryReadsBackExactly) {
  const ImpactResult result =
      sim::contact::simulate_impact(sim::job::racket_job(), {.rate_hz = 10000});
  const testing::ScratchFolder folder;
  const fs::path file = folder / "impact_trajectory.csv";
  sim::job::write_trajectory_csv(file, sim::job::racket_job(), result.trajectory);
  std::ifstream stream(file);
  std::string header, line;
  std::getline(stream, header);
  EXPECT_EQ(header.rfind("time_s,qt_m,qn_m,angle_rad,vt_m_s,vn_m_s,omega_rad_s,normal_force_n,"
                         "tangential_force_n",
                         0),
            0u);
  const auto columns = std::count(header.begin(), header.end(), ',');
  for (const TrajectoryPoint& point : result.trajectory) {
    ASSERT_TRUE(std::getline(stream, line));
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns);
    double time, qt, qn;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &time, &qt, &qn), 3);
    EXPECT_EQ(time, point.time_s);
    EXPECT_EQ(qn, point.state.qn_m);
  }
  EXPECT_FALSE(std::getline(stream, line));
  EXPECT_EQ(result.trajectory.back().time_s, result.contact_s);
}

// Columns of an impact that leaves the plane, and of a second ball.
TEST(ResultFiles, TrajectoryInSpaceHasItsColumns) {
  ImpactJob job = sim::job::racket_job();
  job.initial.vb_m_s = 0.7;
  OtherBody other;
  other.body = job.body;
  job.other = other;
  const ImpactResult result = sim::contact::simulate_impact(job, {.rate_hz = 1000});
  const testing::ScratchFolder folder;
  const fs::path file = folder / "impact_trajectory_in_space.csv";
  sim::job::write_trajectory_csv(file, job, result.trajectory);
  std::ifstream stream(file);
  std::string header, line;
  std::getline(stream, header);
  for (const char* column : {",vb_m_s", ",omega_t_rad_s", ",orientation_w", ",other_vn_m_s"}) {
    EXPECT_NE(header.find(column), std::string::npos) << column;
  }
  ASSERT_TRUE(std::getline(stream, line));
  EXPECT_EQ(std::count(line.begin(), line.end(), ','),
            std::count(header.begin(), header.end(), ','));
  const std::string summary = sim::job::summary_json(job, result);
  EXPECT_NE(summary.find("\"other_final\""), std::string::npos);
}

TEST(ResultFiles, SummaryHasTheKeysAndNullForWhatDoesNotExist) {
  ImpactJob job = sim::job::racket_job();
  const std::string summary = sim::job::summary_json(job, sim::contact::simulate_impact(job));
  for (const char* key :
       {"\"restitution\"", "\"contact_s\"", "\"t_max_compression_s\"", "\"max_deflection_m\"",
        "\"max_force_n\"", "\"final\"", "\"vt_m_s\"", "\"omega_rad_s\"", "\"phases\"",
        "\"start_s\"", "\"end_s\"", "\"energy\"", "\"residual_j\"", "\"warnings\""}) {
    EXPECT_NE(summary.find(key), std::string::npos) << key;
  }
  job.surface_angle_deg = 0;
  job.initial.vn_m_s = -0.01;
  job.contact.damping_n_s_per_m = 40;
  EXPECT_NE(
      sim::job::summary_json(job, sim::contact::simulate_impact(job)).find("\"restitution\": null"),
      std::string::npos);
}

TEST(Motion, PosesFollowTheImpactInWorldAxes) {
  const ImpactJob job = sim::job::racket_job();  // dropped vertically on 15 degrees
  const double fps = 10000, touch = 20.25;
  const auto poses = sim::contact::simulate_motion(job, fps, 120, touch);
  ASSERT_EQ(poses.size(), 120u);
  EXPECT_NEAR(poses[0].time_s, -touch / fps, 1e-15);
  EXPECT_EQ(poses[0].angle_rad, 0);
  // Straight down before: 2 m/s, less what gravity adds later.
  EXPECT_NEAR(poses[0].x_m, 0, 1e-12);
  EXPECT_NEAR(poses[0].y_m, 2 * touch / fps - 0.5 * 9.81 * std::pow(touch / fps, 2), 1e-12);
  double deepest = 0;
  for (const sim::contact::FramePose& pose : poses) deepest = std::max(deepest, pose.compression);
  const ImpactResult impact = sim::contact::simulate_impact(job);
  EXPECT_NEAR(deepest, impact.max_deflection_m / job.body.diameter_m, 2e-4);
  EXPECT_EQ(poses[10].compression, 0);
  EXPECT_EQ(poses[119].compression, 0);
  const double omega = (poses[119].angle_rad - poses[118].angle_rad) * fps;
  EXPECT_NEAR(omega, impact.final.omega_rad_s, 1e-9);
  EXPECT_THROW(sim::contact::simulate_motion(job, 0, 10, 0), InvalidArgument);
}

TEST(ClosedForms, InversesRecoverParametersOverTheirRange) {
  for (const double b : {0.0, 0.5, 5.36, 20.0, 55.0, 80.0}) {  // up to overdamped
    const sim::contact::LinearImpact shot = sim::contact::linear_impact(0.0567, 13385, b, 2);
    const auto found = sim::contact::linear_parameters(0.0567, shot.restitution, shot.contact_s);
    EXPECT_NEAR(found.stiffness, 13385, 1e-6);
    EXPECT_NEAR(found.damping_n_s_per_m, b, 1e-8);
  }
  for (const double b : {0.0, 9.5, 18.0, 40.0}) {
    ImpactJob job = sim::job::wood_published_job();
    job.gravity_m_s2 = 0;
    job.contact.damping_n_s_per_m = b;
    const ImpactResult shot = sim::contact::simulate_impact(job);
    const auto found = sim::contact::hertz_parameters(job.body.mass_kg, 1.69, shot.restitution,
                                                      shot.contact_s, RestitutionDamping::kNone);
    EXPECT_NEAR(found.stiffness / 875000, 1, 1e-7);
    EXPECT_NEAR(found.damping_n_s_per_m, b, 1e-5);
  }
  EXPECT_THROW(sim::contact::linear_parameters(1, 1.2, 1e-3), InvalidArgument);
  EXPECT_THROW(sim::contact::hertz_parameters(1, 1, 0.9, -1, RestitutionDamping::kNone),
               InvalidArgument);
}

TEST(ClosedForms, StrongeNeverCreatesEnergyForAnEccentricRod) {
  const ImpactBody rod{BodyShape::kRod, 0.5, 0.01, 0.3};
  for (double angle = 10; angle <= 170; angle += 5) {
    const double radians = angle * 0.017453292519943295;
    for (const double friction : {0.0, 0.1, 0.5, 1.5}) {
      for (const double vt : {-2.0, 0.0, 2.0}) {
        const ImpactVelocities before{vt, -1, 0};
        const auto after = sim::contact::stronge_rebound(
            rod, -0.15 * std::cos(radians), -0.15 * std::sin(radians), before, 0.7, friction);
        const auto energy = [&rod](const ImpactVelocities& v) {
          return rod.mass_kg * (v.vt_m_s * v.vt_m_s + v.vn_m_s * v.vn_m_s) +
                 rod.inertia() * v.omega_rad_s * v.omega_rad_s;
        };
        EXPECT_LE(energy(after), energy(before) * (1 + 1e-12)) << angle << " " << friction;
      }
    }
  }
}

}  // namespace
}  // namespace impactdic
