// rod, fit, compare and the rod's simulate jobs from outside: files written, jobs that rerun to the
// same figures, and errors of one line that name file and key.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sim/rod/rod_impact.h"
#include "tests/support/program.h"
#include "tests/support/synthetic_track.h"

namespace impactdic::testing {
namespace {

using Json = nlohmann::json;

Json read_json(const std::filesystem::path& file) { return Json::parse(std::ifstream(file)); }

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

void expect_done(const std::string& arguments) {
  const Outcome outcome = run_program(arguments);
  EXPECT_EQ(outcome.status, 0) << arguments << "\n" << outcome.err;
}

void expect_one_line(const std::string& arguments, int status, const std::string& says) {
  const Outcome outcome = run_program(arguments);
  EXPECT_EQ(outcome.status, status) << arguments << "\n" << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
}

void racket_shot(const std::filesystem::path& file, double angle_deg, unsigned seed) {
  SyntheticTrack track;
  track.job.normal = NormalModel::kLinearSpringDamper;
  track.job.friction = angle_deg == 0 ? FrictionModel::kNone : FrictionModel::kCoulomb;
  track.job.body.shape = BodyShape::kHollowSphere;
  track.job.body.mass_kg = 0.0567;
  track.job.body.diameter_m = 0.067;
  track.job.contact.stiffness = 12526;
  track.job.contact.damping_n_s_per_m = 6.85;
  track.job.contact.friction_kinetic = 0.05;
  track.job.surface_angle_deg = angle_deg;
  track.job.initial.vt_m_s = -3.3 * std::sin(angle_deg * kRadPerDeg);
  track.job.initial.vn_m_s = -3.3 * std::cos(angle_deg * kRadPerDeg);
  track.position_noise_m = 20e-6;
  track.seed = seed;
  write_track(track, file);
}

std::string fit_text(const std::string& tracks, const std::string& method) {
  return "normal = \"linear_spring_damper\"\nfriction = \"none\"\ntracks = [" + tracks +
         "]\n[body]\nshape = \"hollow_sphere\"\nmass_kg = 0.0567\ndiameter_m = 0.067\n"
         "[surface]\nangle_deg = 0\n[fit]\nmethod = \"" +
         method + "\"\nparameters = [\"stiffness_n_per_m\", \"damping_n_s_per_m\"]\n";
}

TEST(FitCommand, WritesFiguresAndAJobThatRerunsToThem) {
  const ScratchFolder folder;
  racket_shot(folder / "a.csv", 0, 1);
  write(folder / "job.toml", fit_text("\"a.csv\"", "trajectory"));
  expect_done("fit " + quoted(folder / "job.toml") + " -o " + quoted(folder / "out"));
  const Json summary = read_json(folder / "out" / "summary.json");
  const Json& k = summary["parameters"]["stiffness_n_per_m"];
  EXPECT_NEAR(k["value"].get<double>(), 12526, 4 * k["sd"].get<double>());
  EXPECT_TRUE(k["determined"].get<bool>());
  EXPECT_EQ(k["ci95"].size(), 2u);
  EXPECT_EQ(summary["covariance"]["rows"].size(), 3u);  // with the contact time
  expect_done("fit " + quoted(folder / "out" / "job.toml") + " -o " + quoted(folder / "again"));
  EXPECT_EQ(summary, read_json(folder / "again" / "summary.json"));
}

TEST(FitCommand, TheGridWritesItsErrorSurfaces) {
  const ScratchFolder folder;
  racket_shot(folder / "a.csv", 0, 1);
  write(folder / "job.toml", fit_text("\"a.csv\"", "published_grid"));
  expect_done("fit " + quoted(folder / "job.toml") + " -o " + quoted(folder / "out"));
  std::ifstream errors(folder / "out" / "errors_0.csv");
  std::string line;
  int lines = 0;
  while (std::getline(errors, line)) ++lines;
  EXPECT_EQ(lines, 1 + 31 * 21);
  EXPECT_TRUE(std::filesystem::exists(folder / "out" / "errors_spline_0.csv"));
}

TEST(FitCommand, BadJobsNameFileAndKey) {
  const ScratchFolder folder;
  racket_shot(folder / "a.csv", 0, 1);
  const std::string good = fit_text("\"a.csv\"", "trajectory");
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    write(folder / "job.toml", text);
    return "fit " + quoted(folder / "job.toml") + " -o " + quoted(folder / "out");
  };
  expect_one_line(changed("mass_kg = 0.0567", "mass_kg = -1.0"), 2, "job.toml: body.mass_kg");
  expect_one_line(changed("mass_kg", "mass"), 2, "mass_kg");
  expect_one_line(changed("method", "methods"), 2, "fit.methods");
  expect_one_line(changed("\"damping_n_s_per_m\"", "\"damping\""), 2, "fit.parameters");
  expect_one_line(changed("\"trajectory\"", "\"guess\""), 2, "fit.method");
  expect_one_line(changed("\"a.csv\"", ""), 2, "tracks");
  expect_one_line(changed("a.csv", "b.csv"), 1, "b.csv");
  std::ifstream in(folder / "a.csv");
  std::string track((std::istreambuf_iterator<char>(in)), {});
  track.replace(track.find(",ok,"), 4, ",ok,nan");
  write(folder / "b.csv", track);
  expect_one_line(changed("a.csv", "b.csv"), 1, "b.csv, line 2, column cx_px");
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(CompareCommand, CalibratesOnNormalShotsAndPredictsObliqueOnes) {
  const ScratchFolder folder;
  racket_shot(folder / "normal.csv", 0, 1);
  racket_shot(folder / "oblique.csv", 15, 2);
  std::string text = fit_text("\"oblique.csv\"", "trajectory");
  text.insert(0,
              "calibrate_on = [\"normal.csv\"]\nmodels = [\"coulomb\", \"none\"]\n"
              "friction_source = \"effective_sound\"\n");
  // Each track knows its own surface.
  text.erase(text.find("[surface]"), std::string("[surface]\nangle_deg = 0\n").size());
  write(folder / "job.toml", text);
  expect_done("compare " + quoted(folder / "job.toml") + " -o " + quoted(folder / "out"));
  for (const char* name : {"comparison.csv", "restitution.csv", "restitution_by_angle.csv"}) {
    EXPECT_GT(std::filesystem::file_size(folder / "out" / name), 100u) << name;
  }
  const Json shot = read_json(folder / "out" / "summary.json")["shots"][0];
  ASSERT_EQ(shot["models"].size(), 2u);
  EXPECT_NEAR(shot["measured"]["surface_angle_deg"].get<double>(), 15, 1e-9);
  EXPECT_LT(std::abs(shot["models"][0]["relative_error"]["vn"].get<double>()), 0.01);
  EXPECT_TRUE(shot["measured"]["effective_friction"].contains("rolling_cap"));
}

std::string markers() {
  // The flexible rod's rebound at 45 degrees, 500 frames/s, marked at -0.12, 0, 0.12 m.
  RodJob job = flexible_rod_preset();
  job.angle_rad = 45 * kRadPerDeg;
  job.vn_m_s = -2;
  const RodImpact impact = sim::rod::simulate_rod(job);
  std::string text = "time_s,x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,x3_m,y3_m,z3_m\n";
  for (int i = 0; i < 120; ++i) {
    const double time = i / 500.0, t = time - 0.1613;
    const double x = t < 0 ? 0 : impact.vt_m_s * t;
    const double y = (t < 0 ? -2 * t : impact.vn_m_s * t) - 9.81 / 2 * t * t;
    const double angle = job.angle_rad + (t < 0 ? 0 : impact.omega_rad_s * t);
    text += shortest(time);
    for (double along : {-0.12, 0.0, 0.12}) {
      text += "," + shortest(x + along * std::cos(angle)) + "," +
              shortest(y + along * std::sin(angle)) + ",0.5";
    }
    text += "\n";
  }
  return text;
}

TEST(RodCommand, MeasuresPredictsAndComparesDents) {
  const ScratchFolder folder;
  write(folder / "markers.csv", markers());
  write(folder / "dents.csv", "angle_deg,speed_m_s,depth_m\n45,2.487,7.9e-5\n");
  expect_done("rod " + quoted(folder / "markers.csv") + " --deformations " +
              quoted(folder / "dents.csv") + " -o " + quoted(folder / "out"));
  const Json summary = read_json(folder / "out" / "summary.json");
  const Json& flexible = summary["predictions"][1];
  EXPECT_EQ(flexible["model"], "flexible_rod");
  EXPECT_NEAR(summary["after"]["omega_rad_s"]["value"].get<double>(),
              flexible["omega_rad_s"].get<double>(), 0.01);
  EXPECT_NEAR(summary["before"]["free_fall"]["gravity_m_s2"]["value"].get<double>(), 9.81, 1e-3);
  EXPECT_EQ(summary["impulse_closure"]["tangential_sign"], 1);
  EXPECT_TRUE(std::filesystem::exists(folder / "out" / "motion.csv"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out" / "deformation.csv"));
  expect_one_line("rod " + quoted(folder / "dents.csv") + " -o " + quoted(folder / "bad"), 1,
                  "time_s");
  expect_one_line(
      "rod " + quoted(folder / "markers.csv") + " --mass-kg -1 -o " + quoted(folder / "bad"), 2,
      "mass_kg");
}

TEST(SimulateCommand, TheReadyRodJobsGiveTheCheckValues) {
  const ScratchFolder folder;
  const std::filesystem::path jobs = std::filesystem::path(IMPACTDIC_SOURCE_DIR) / "sim" / "jobs";
  expect_done("simulate " + quoted(jobs / "rod_45_flexible.toml") + " -o " +
              quoted(folder / "out"));
  const Json summary = read_json(folder / "out" / "summary.json");
  EXPECT_NEAR(summary["restitution"].get<double>(), .597, .0005);
  EXPECT_NEAR(summary["final"]["omega_rad_s"].get<double>(), -20.8, .05);
  expect_done("simulate " + quoted(folder / "out" / "job.toml") + " -o " +
              quoted(folder / "again"));
  EXPECT_EQ(summary["restitution"], read_json(folder / "again" / "summary.json")["restitution"]);
}

}  // namespace
}  // namespace impactdic::testing
