// The whole laboratory: an impact is integrated, filmed with pixels and noise of the pattern,
// tracked, and the parameters that were put in are fitted from the track.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

using Json = nlohmann::json;

constexpr double kStiffness = 12526, kDamping = 6.85, kFriction = 0.0941;

void must(const std::string& arguments) {
  const Outcome outcome = run_program(arguments);
  if (outcome.status != 0) throw std::runtime_error(arguments + "\n" + outcome.err);
}

Json read_json(const std::filesystem::path& file) { return Json::parse(std::ifstream(file)); }

const std::string kBody =
    "[body]\nshape = \"hollow_sphere\"\nmass_kg = 0.0567\ndiameter_m = 0.067\n";

std::string simulate_job(bool oblique) {
  return std::string("normal = \"linear_spring_damper\"\nfriction = \"") +
         (oblique ? "coulomb" : "none") + "\"\n" + kBody +
         "[contact]\nstiffness_n_per_m = 12526.0\ndamping_n_s_per_m = 6.85\n" +
         (oblique ? "friction_kinetic = 0.0941\n" : "") +
         "[surface]\nangle_deg = " + (oblique ? "30.0" : "0.0") +
         "\n[initial]\nvt_m_s = " + (oblique ? "-1.81" : "0.0") +
         "\nvn_m_s = " + (oblique ? "-3.52" : "-3.26") + "\n";
}

std::string fit_job(bool oblique) {
  return std::string("normal = \"linear_spring_damper\"\nfriction = \"") +
         (oblique ? "coulomb" : "none") + "\"\ntracks = [\"track/track.csv\"]\n" + kBody +
         "[fit]\nparameters = [\"stiffness_n_per_m\", \"damping_n_s_per_m\"" +
         (oblique ? ", \"friction_kinetic\"" : "") + "]\n";
}

struct ClosedLoop {
  Json simulated, tracked, fitted;
};

ClosedLoop close_loop(bool oblique) {
  const ScratchFolder folder;
  std::ofstream(folder / "impact.toml") << simulate_job(oblique);
  std::ofstream(folder / "fit.toml") << fit_job(oblique);
  must("simulate " + quoted(folder / "impact.toml") + " -o " + quoted(folder / "sim"));
  must("synth --simulate " + quoted(folder / "impact.toml") +
       " --pattern f1 --noise 2 --size 330x400 --frames 130 --touch-frame 32.37 -o " +
       quoted(folder / "clip"));
  must("track " + quoted(folder / "clip/video.tif") + " --fps 10000 --ball-diameter-mm 67" +
       " --spacing 12 --inertia-factor 0.66666666666666667 --surface-angle-deg " +
       (oblique ? "30" : "0") + " -o " + quoted(folder / "track"));
  must("fit " + quoted(folder / "fit.toml") + " -o " + quoted(folder / "fit"));
  return {read_json(folder / "sim/summary.json"),
          read_json(folder / "track/summary.json")["impact"],
          read_json(folder / "fit/summary.json")["shots"][0]};
}

// Within the accuracy stated, and within three of the deviations that the fit itself states.
void expect_found(const Json& estimate, double truth, double tolerance) {
  const double value = estimate["value"], sd = estimate["sd"];
  EXPECT_NEAR(value, truth, tolerance) << estimate;
  EXPECT_NEAR(value, truth, 3 * sd) << estimate;
}

// The deviation less what scale and rate, which `fit` takes as exact, have in it.
double own_sd(const Json& figure) {
  double variance = std::pow(figure["sd"].get<double>(), 2);
  for (const char* common : {"scale", "time"}) {
    if (!figure.contains("sd_parts")) continue;
    variance -= std::pow(figure["sd_parts"].value(common, 0.0), 2);
  }
  return std::sqrt(variance);
}

// What `fit` reads from a table is what `track` has measured, but for the rounding of the table.
void expect_same(const Json& fitted, const Json& tracked, const std::string& what) {
  const double value = tracked["value"], sd = own_sd(tracked);
  EXPECT_NEAR(fitted["value"].get<double>(), value, 1e-3 * sd + 1e-9) << what;
  EXPECT_NEAR(fitted["sd"].get<double>(), sd, 1e-3 * sd) << what;
}

void expect_one_analysis(const Json& shot, const Json& impact) {
  ASSERT_EQ(impact["status"], "found");
  for (const char* side : {"before", "after"}) {
    EXPECT_EQ(shot[side]["frames"].get<std::vector<double>>(),
              impact[side]["frames_used"].get<std::vector<double>>());
    for (const char* key : {"vt_m_s", "vn_m_s", "omega_rad_s"}) {
      expect_same(shot[side][key], impact[side][key], std::string(side) + " " + key);
    }
  }
  EXPECT_NEAR(shot["contact_start_s"]["value"].get<double>(), impact["t0"]["time_s"].get<double>(),
              1e-3 * impact["t0"]["sd_s"].get<double>());
  expect_same(shot["contact_s"], impact["contact_s"], "contact_s");
  expect_same(shot["max_deflection_m"], impact["max_deflection_m"], "max_deflection_m");
  expect_same(shot["restitution"], impact["restitution"], "restitution");
  const Json &mine = shot["effective_friction"], &theirs = impact["friction"];
  expect_same({{"value", mine["with_gravity"]}, {"sd", mine["sd"]}}, theirs["gravity_corrected"],
              "friction");
  const auto near = [](const Json& a, const Json& b) {
    EXPECT_NEAR(a.get<double>(), b["value"].get<double>(), 1e-3 * b["sd"].get<double>());
  };
  near(mine["published"], theirs["eq_3_12"]);
  near(mine["rolling_cap"], theirs["rolling_cap"]);
}

void expect_truth(bool oblique) {
  const auto [simulated, tracked, fitted] = close_loop(oblique);
  expect_one_analysis(fitted["shot"], tracked);
  const Json& parameters = fitted["parameters"];
  expect_found(parameters["stiffness_n_per_m"], kStiffness, 0.005 * kStiffness);
  expect_found(parameters["damping_n_s_per_m"], kDamping, 0.005 * kDamping);
  expect_found(fitted["shot"]["restitution"], simulated["restitution"], 0.001);
  for (const char* key : {"restitution", "contact_s", "t_max_compression_s"}) {
    expect_found(fitted["derived"][key], simulated[key], 0.002 * simulated[key].get<double>());
  }
  if (oblique) expect_found(parameters["friction_kinetic"], kFriction, 0.001);
}

TEST(ClosedLoop, NormalImpactGivesBackItsParameters) { expect_truth(false); }

TEST(ClosedLoop, ObliqueImpactGivesBackItsParametersAndFriction) { expect_truth(true); }

}  // namespace
}  // namespace impactdic::testing
