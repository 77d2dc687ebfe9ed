// Jobs and tracks that cannot be done: simulate, fit and compare end with status 2 (the request) or
// 1 (the file), one line on stderr that names file and key, and no results.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>

#include "tests/support/program.h"
#include "tests/support/synthetic_track.h"

namespace impactdic::testing {
namespace {

const char* const kBall =
    "[body]\nshape = \"hollow_sphere\"\nmass_kg = 0.0567\ndiameter_m = 0.067\n";
const std::string kSimulate = std::string(
                                  "normal = \"linear_spring_damper\"\n"
                                  "friction = \"coulomb\"\n") +
                              kBall +
                              "[contact]\nstiffness_n_per_m = 12526.0\ndamping_n_s_per_m = 6.85\n"
                              "friction_kinetic = 0.05\n[initial]\nvt_m_s = 0.5\nvn_m_s = -3.0\n";
const std::string kFit = std::string(
                             "normal = \"linear_spring_damper\"\nfriction = \"none\"\n"
                             "tracks = [\"track.csv\"]\n") +
                         kBall +
                         "[surface]\nangle_deg = 0.0\n[fit]\nmethod = \"trajectory\"\n"
                         "parameters = [\"stiffness_n_per_m\", \"damping_n_s_per_m\"]\n";
const std::string kCompare = std::string(
                                 "normal = \"linear_spring_damper\"\nfriction = \"none\"\n"
                                 "tracks = [\"track.csv\"]\nmodels = [\"none\"]\n") +
                             kBall +
                             "[contact]\nstiffness_n_per_m = 12526.0\ndamping_n_s_per_m = 6.85\n"
                             "[surface]\nangle_deg = 0.0\n";

SyntheticTrack shot() {
  SyntheticTrack track;
  track.job.normal = NormalModel::kLinearSpringDamper;
  track.job.friction = FrictionModel::kNone;
  track.job.body = {BodyShape::kHollowSphere, 0.0567, 0.067};
  track.job.contact.stiffness = 12526;
  track.job.contact.damping_n_s_per_m = 6.85;
  track.job.initial.vn_m_s = -3.26;
  track.position_noise_m = 20e-6;
  return track;
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

class BadJob : public ::testing::Test {
 protected:
  BadJob() { write_track(shot(), folder_ / "track.csv"); }

  void expect_refused(const std::string& command, const std::string& job, int status,
                      const std::string& names) {
    std::ofstream(folder_ / "job.toml") << job;
    const Outcome outcome = run_program(command + " " + quoted(folder_ / "job.toml") + " -o " +
                                        quoted(folder_ / "out"));
    EXPECT_EQ(outcome.status, status) << command << " " << names << "\n" << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.err.rfind("impactdic: error: ", 0), 0u) << outcome.err;
    EXPECT_NE(outcome.err.find(names), std::string::npos) << names << "\n" << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out" / "summary.json"));
  }

  // The same for each command, by a change of what they share.
  void expect_all_refuse(const std::string& from, const std::string& to, const std::string& names) {
    expect_refused("simulate", with(kSimulate, from, to), 2, names);
    expect_refused("fit", with(kFit, from, to), 2, names);
    expect_refused("compare", with(kCompare, from, to), 2, names);
  }

  void change_track(const std::function<void(std::string&)>& change) {
    std::string text = read_text(folder_ / "track.csv");
    change(text);
    std::ofstream(folder_ / "track.csv") << text;
  }

  const ScratchFolder folder_;
};

TEST_F(BadJob, UnknownKeyIsNamed) {
  expect_all_refuse("mass_kg = 0.0567", "mass_kg = 0.0567\ncolour = 3", "job.toml: body.colour");
  expect_refused("simulate", "speed = 1\n" + kSimulate, 2, "job.toml: speed");
  expect_refused("fit", kFit + "guess = 1\n", 2, "job.toml: fit.guess");
  expect_refused("compare", kCompare + "[formula]\nbeta = 0\n", 2, "job.toml: formula.beta");
}

TEST_F(BadJob, MissingUnitIsNamed) {
  expect_all_refuse("mass_kg", "mass", "mass_kg");
  expect_all_refuse("diameter_m", "diameter", "diameter_m");
  expect_refused("simulate", with(kSimulate, "stiffness_n_per_m", "stiffness"), 2,
                 "job.toml: contact.stiffness_n_per_m");
  expect_refused("simulate", with(kSimulate, "vn_m_s", "vn"), 2, "job.toml: initial.vn_m_s");
}

TEST_F(BadJob, ImpossibleValueIsNamed) {
  expect_all_refuse("mass_kg = 0.0567", "mass_kg = -0.0567", "job.toml: body.mass_kg");
  expect_all_refuse("diameter_m = 0.067", "diameter_m = 0.0", "job.toml: body.diameter_m");
  expect_all_refuse("mass_kg = 0.0567", "mass_kg = nan", "job.toml: body.mass_kg");
  expect_all_refuse("mass_kg = 0.0567", "mass_kg = \"heavy\"", "job.toml: body.mass_kg");
  expect_all_refuse("hollow_sphere", "cube", "job.toml: body.shape");
  expect_all_refuse("linear_spring_damper", "rubber", "job.toml: normal");
  expect_refused("simulate", with(kSimulate, "vn_m_s = -3.0", "vn_m_s = 3.0"), 2,
                 "job.toml: initial.vn_m_s");
  expect_refused("simulate", with(kSimulate, "= 12526.0", "= -1.0"), 2,
                 "job.toml: contact.stiffness_n_per_m");
  expect_refused("fit", with(kFit, "\"damping_n_s_per_m\"", "\"colour\""), 2,
                 "job.toml: fit.parameters");
  expect_refused("compare", with(kCompare, "[\"none\"]", "[\"magic\"]"), 2, "job.toml: models");
  expect_refused("simulate", "model = \"magic\"\n", 2, "job.toml: model");
  expect_refused("simulate",
                 "model = \"garwin\"\npreset = \"published\"\n" + std::string(kBall) +
                     "[initial]\nvn_m_s = 1.0\n",
                 2, "job.toml: initial.vn_m_s");
  expect_refused("simulate",
                 "model = \"kelvin_voigt\"\nfriction = \"none\"\n" + std::string(kBall) +
                     "[contact]\nrestitution = 1.5\ncontact_s = 0.006\n",
                 2, "job.toml: contact.restitution");
}

TEST_F(BadJob, WhatIsNoJobOrNoTrackIsNamed) {
  for (const char* command : {"simulate", "fit", "compare"}) {
    expect_refused(command, "this is = not [ TOML\n", 1, "job.toml, line 1");
    const Outcome outcome =
        run_program(std::string(command) + " " + quoted(folder_ / "nowhere.toml") + " -o " +
                    quoted(folder_ / "out"));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.err.find("nowhere.toml"), std::string::npos) << outcome.err;
  }
  for (const auto& [command, job] : {std::pair{"fit", kFit}, std::pair{"compare", kCompare}}) {
    expect_refused(command, with(job, "track.csv", "lost.csv"), 1, "lost.csv");
    expect_refused(command, with(job, "[\"track.csv\"]", "[]"), 2, "job.toml: tracks");
  }
}

TEST_F(BadJob, NanInATrackIsNamed) {
  change_track([](std::string& text) { text = with(text, ",ok,", ",ok,nan"); });
  expect_refused("fit", kFit, 1, "track.csv, line 2, column cx_px");
  expect_refused("compare", kCompare, 1, "track.csv, line 2, column cx_px");
}

TEST_F(BadJob, MissingColumnOrTimeIsNamed) {
  change_track([](std::string& text) { text = with(text, "rot_sd_deg", "rot_sd"); });
  expect_refused("fit", kFit, 1, "'rot_sd_deg' is missing");
  write_track(shot(), folder_ / "track.csv");
  change_track([](std::string& text) { text = with(text, "\n50,0.005,", "\n50,0.05,"); });
  expect_refused("compare", kCompare, 1, "column time_s");
}

TEST_F(BadJob, ShotWithoutContactIsNamed) {
  SyntheticTrack falling = shot();
  falling.frames_contact = falling.frames_after = 0;
  write_track(falling, folder_ / "track.csv");
  expect_refused("fit", kFit, 1, "track.csv");
  expect_refused("compare", kCompare, 1, "no contact");
}

TEST_F(BadJob, TableOfShotsIsChecked) {
  const std::string job = with(kCompare, "tracks = [\"track.csv\"]", "shots = [\"shots.csv\"]");
  const auto table = [&](const std::string& text) {
    std::ofstream(folder_ / "shots.csv") << text;
    return job;
  };
  const std::string header =
      "shot,surface_angle_deg,vt_before_m_s,vn_before_m_s,vt_after_m_s,vn_after_m_s";
  expect_refused("compare", table(header + ",speed\na,0,0,-1,0,0.8,3\n"), 1, "'speed'");
  expect_refused("compare", table(header + "\na,0,0,1,0,0.8\n"), 1, "line 2, column vn_before_m_s");
  expect_refused("compare", table(header + "\na,0,0,,0,0.8\n"), 1, "line 2, column vn_before_m_s");
  expect_refused("compare", table(header + "\n"), 1, "shots.csv");
  expect_refused("compare",
                 "friction_source = \"effective_sound\"\n" + table(header + "\na,0,0,-1,0,0.8\n"),
                 2, "shots.csv: a");
}

}  // namespace
}  // namespace impactdic::testing
