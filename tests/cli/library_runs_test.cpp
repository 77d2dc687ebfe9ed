// The typed runs of the library against the commands: the same job gives the same bytes.
#include <gtest/gtest.h>
#include <impactdic/compare.h>
#include <impactdic/fit.h>
#include <impactdic/rod.h>
#include <impactdic/simulate.h>
#include <impactdic/study.h>
#include <impactdic/synth.h>
#include <impactdic/units.h>

#include <cmath>
#include <cstring>
#include <sstream>

#include "host/base/parse.h"
#include "host/report/job/compare_files.h"
#include "host/report/job/fit_files.h"
#include "host/report/job/rod_files.h"
#include "host/report/job/study_files.h"
#include "host/video/frame_source.h"
#include "sim/compare/compare_job.h"
#include "sim/fit/fit_job.h"
#include "sim/job/job_toml.h"
#include "sim/job/rebound_job.h"
#include "sim/job/result_files.h"
#include "sim/rod/markers.h"
#include "sim/rod/rod_job.h"
#include "sim/shot/track_table.h"
#include "sim/speckle/motion.h"
#include "tests/support/program.h"
#include "tests/support/racket_job.h"
#include "tests/support/synthetic_track.h"

namespace impactdic::testing {
namespace {

namespace fs = std::filesystem;

const fs::path kJobs = fs::path(IMPACTDIC_SOURCE_DIR) / "sim" / "jobs";

void run_command(const std::string& arguments) {
  const Outcome outcome = run_program(arguments);
  ASSERT_EQ(outcome.status, 0) << arguments << "\n" << outcome.err;
}

void expect_same_file(const fs::path& a, const fs::path& b) {
  const std::string one = read_text(a), other = read_text(b);
  EXPECT_GT(one.size(), 50u) << a;
  EXPECT_EQ(one, other) << a;
}

// What `simulate` writes of the job in `toml`.
void simulate_command(const ScratchFolder& folder, const std::string& toml) {
  sim::job::write_text(folder / "job.toml", toml);
  run_command("simulate " + quoted(folder / "job.toml") + " -q -o " + quoted(folder / "cli"));
}

TEST(LibrarySimulate, BallGivesTheCommandsBytes) {
  const ScratchFolder folder;
  for (const double rate_hz : {0.0, 25000.0}) {
    const SimulateRequest request{racket_job(), rate_hz, {}};
    const ImpactResult result = simulate(request);
    sim::job::write_trajectory_csv(folder / "trajectory.csv", request.impact, result.trajectory);
    sim::job::write_text(folder / "summary.json", sim::job::summary_json(request.impact, result));
    fs::remove_all(folder / "cli");
    simulate_command(folder, sim::job::to_toml(request));
    expect_same_file(folder / "trajectory.csv", folder / "cli" / "trajectory.csv");
    expect_same_file(folder / "summary.json", folder / "cli" / "summary.json");
  }
}

TEST(LibrarySimulate, PointsAtStatedTimesLieOnTheSamePath) {
  SimulateRequest request{racket_job(), 0, {-1e-3, 0, 2e-3, 9e-3}};
  const ImpactResult at = simulate(request);
  ASSERT_EQ(at.trajectory.size(), 4u);
  EXPECT_EQ(at.trajectory[0].state.vn_m_s,
            request.impact.initial.vn_m_s + 9.81 * std::cos(15 * kRadPerDeg) * 1e-3);
  request.times_s.clear();
  request.rate_hz = 500;
  const ImpactResult steady = simulate(request);
  EXPECT_EQ(steady.trajectory[1].time_s, 2e-3);
  EXPECT_EQ(steady.trajectory[1].state.qn_m, at.trajectory[2].state.qn_m);
}

TEST(LibrarySimulate, FormulaAndRodGiveTheCommandsBytes) {
  const ScratchFolder folder;
  ReboundJob formula;
  formula.model = ReboundModel::kStronge;
  formula.body = racket_job().body;
  formula.restitution = 0.8;
  formula.friction_kinetic = 0.1;
  formula.initial.vt_m_s = 1, formula.initial.vn_m_s = -2;
  sim::job::write_text(folder / "summary.json",
                       sim::job::rebound_summary_json(formula, simulate(formula)));
  simulate_command(folder, sim::job::to_toml(formula));
  expect_same_file(folder / "summary.json", folder / "cli" / "summary.json");

  RodModel rod{false, ModelPreset::kPublished, rigid_rod_preset()};
  rod.rod.angle_rad = 40 * kRadPerDeg;
  rod.rod.vn_m_s = -2;
  rod.rod.sample_rate_hz = 1e5;
  sim::job::write_text(folder / "job.toml", sim::rod::to_toml(rod));
  rod = sim::rod::read_rod_job(folder / "job.toml");  // its angle is in degrees there
  const RodImpact impact = simulate(rod.rod);
  sim::rod::write_rod_trajectory(folder / "trajectory.csv", impact);
  sim::job::write_text(folder / "summary.json", sim::rod::rod_summary_json(rod, impact));
  fs::remove_all(folder / "cli");
  run_command("simulate " + quoted(folder / "job.toml") + " -q -o " + quoted(folder / "cli"));
  expect_same_file(folder / "trajectory.csv", folder / "cli" / "trajectory.csv");
  expect_same_file(folder / "summary.json", folder / "cli" / "summary.json");
}

FitRequest racket_fit(const std::vector<fs::path>& tracks) {
  FitRequest request;
  request.impact = racket_job();
  request.impact.initial = {};
  request.impact.surface_angle_deg = 0;
  request.parameters = {FitParameter::kStiffness, FitParameter::kDamping};
  for (const fs::path& track : tracks) request.shots.push_back({track, 15, {}});
  return request;
}

std::vector<fs::path> racket_tracks(const ScratchFolder& folder, int count) {
  std::vector<fs::path> files;
  for (int i = 0; i < count; ++i) {
    SyntheticTrack track;
    track.job = racket_job();
    track.position_noise_m = 20e-6;
    track.seed = static_cast<unsigned>(i) + 1;
    files.push_back(folder / ("track_" + std::to_string(i) + ".csv"));
    write_track(track, files.back());
  }
  return files;
}

TEST(LibraryFit, GivesTheCommandsBytesFromFilesAndFromMemory) {
  const ScratchFolder folder;
  FitRequest request = racket_fit(racket_tracks(folder, 2));
  sim::job::write_text(folder / "job.toml", sim::fit::to_toml(request));
  run_command("fit " + quoted(folder / "job.toml") + " -q -o " + quoted(folder / "cli"));
  for (const bool in_memory : {false, true}) {
    const fs::path out = folder / (in_memory ? "memory" : "files");
    fs::create_directories(out);
    for (FitShot& shot : request.shots) {
      if (in_memory) shot.in_memory = sim::shot::read_track(shot.track);
    }
    report::write_fit(out, request, fit(request));
    expect_same_file(out / "summary.json", folder / "cli" / "summary.json");
    expect_same_file(out / "parameters.csv", folder / "cli" / "parameters.csv");
  }
}

TEST(LibraryFit, ACancelledFitKeepsTheShotsThatAreDone) {
  const ScratchFolder folder;
  FitRequest request = racket_fit(racket_tracks(folder, 3));
  request.threads = 1;
  int told = 0;
  RunControl control;
  control.progress = [&](const Progress& p) { told = static_cast<int>(p.done); };
  control.cancelled = [&] { return told == 1; };
  const FitResult result = fit(request, control);
  EXPECT_TRUE(result.cancelled);
  ASSERT_EQ(result.shots.size(), 1u);
  EXPECT_EQ(result.pooled.size(), 2u);
  EXPECT_EQ(result.pooled[0].mean, result.shots[0].parameters[0].value);
}

TEST(LibraryCompare, GivesTheCommandsBytes) {
  const ScratchFolder folder;
  run_command("compare " + quoted(kJobs / "compare_wood.toml") + " -q -o " +
              quoted(folder / "cli"));
  CompareRequest request = sim::compare::read_compare_job(kJobs / "compare_wood.toml");
  request.threads = 1;
  const fs::path out = folder / "library";
  fs::create_directories(out);
  report::write_comparison(out, request, compare(request));
  for (const char* name : {"summary.json", "comparison.csv", "phases.csv", "restitution.csv",
                           "restitution_by_angle.csv"}) {
    expect_same_file(out / name, folder / "cli" / name);
  }
}

// A blow at 45 degrees seen at 500 frames/s.
std::string blow_markers() {
  RodJob job = rigid_rod_preset();
  job.angle_rad = 45 * kRadPerDeg;
  job.vn_m_s = -2;
  const RodImpact impact = simulate(job);
  std::string text = "time_s,x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,x3_m,y3_m,z3_m\n";
  for (int i = 0; i < 120; ++i) {
    const double time = i / 500.0, t = time - 0.1613;
    const double x = t < 0 ? 0 : impact.vt_m_s * t;
    const double y = (t < 0 ? -2 * t : impact.vn_m_s * t) - 9.81 / 2 * t * t;
    const double angle = job.angle_rad + (t < 0 ? 0 : impact.omega_rad_s * t);
    text += shortest(time);
    for (const double along : {-0.12, 0.0, 0.12}) {
      text += "," + shortest(x + along * std::cos(angle)) + "," +
              shortest(y + along * std::sin(angle)) + ",0.5";
    }
    text += "\n";
  }
  return text;
}

TEST(LibraryRod, GivesTheCommandsBytes) {
  const ScratchFolder folder;
  sim::job::write_text(folder / "markers.csv", blow_markers());
  sim::job::write_text(folder / "dents.csv", "angle_deg,speed_m_s,depth_m\n45,2.487,7.9e-5\n");
  run_command("rod " + quoted(folder / "markers.csv") +
              " --friction 0.2 --yield-strength-pa 3.5e8" + " --deformations " +
              quoted(folder / "dents.csv") + " -q -o " + quoted(folder / "cli"));
  RodRequest request;
  request.markers = sim::rod::read_markers(folder / "markers.csv");
  request.measure.friction_kinetic = 0.2;
  request.yield_strength_pa = 3.5e8;
  request.deformations = {{45, 2.487, 7.9e-5, kNotMeasured}};
  const fs::path out = folder / "library";
  fs::create_directories(out);
  report::write_rod(out, request, measure_rod(request));
  for (const char* name : {"motion.csv", "summary.json", "deformation.csv"}) {
    expect_same_file(out / name, folder / "cli" / name);
  }
}

SynthRequest small_clip() {
  SynthRequest request;
  request.pattern = "b2";
  request.radius_px = 30;
  request.frames = 6;
  request.motion = ConstantMotion{{}, 0.37, -0.61, 3, 0};
  request.scene.width = 100, request.scene.height = 90;
  request.scene.noise_sigma = 2;
  request.seed = 5;
  request.hidden = 0.2;
  return request;
}

TEST(LibrarySynth, GivesTheCommandsPicturesAndTruth) {
  const ScratchFolder folder;
  run_command(
      "synth --pattern b2 --radius-px 30 --frames 6 --velocity-px 0.37,-0.61 --rotation-deg 3 "
      "--size 100x90 --noise 2 --seed 5 --occlude 0.2 -q -o " +
      quoted(folder / "cli"));
  const SynthRequest request = small_clip();
  std::vector<Frame> frames;
  const SynthResult result = synthesize(request, [&](const Frame& f) { frames.push_back(f); });
  EXPECT_FALSE(result.cancelled);
  ASSERT_EQ(frames.size(), 6u);
  const auto clip = video::open_video({(folder / "cli" / "video.tif").string()});
  Frame read;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    clip->read(static_cast<std::int64_t>(k), read);
    ASSERT_EQ(read.byte_count(), frames[k].byte_count());
    EXPECT_EQ(std::memcmp(read.bytes(), frames[k].bytes(), read.byte_count()), 0) << k;
  }
  sim::speckle::write_truth_csv(folder / "truth.csv", result.truth.poses, request.radius_px,
                                request.fps);
  expect_same_file(folder / "truth.csv", folder / "cli" / "truth.csv");
}

TEST(LibrarySynth, ACancelledClipKeepsItsFirstFrames) {
  std::size_t seen = 0;
  RunControl control;
  control.cancelled = [&] { return seen >= 2; };
  SynthRequest request = small_clip();
  request.frames = 400;
  const SynthResult result = synthesize(
      request, [&](const Frame&) { ++seen; }, control);
  EXPECT_TRUE(result.cancelled);
  EXPECT_EQ(result.frames, seen);
  EXPECT_GE(seen, 2u);
  EXPECT_LT(seen, 400u);
  EXPECT_EQ(result.truth.poses.size(), 400u);
}

// Every column but the times, which no two runs share.
void expect_same_table(const fs::path& a, const fs::path& b, const std::string& time_column) {
  const CsvTable one(a), other(b);
  ASSERT_EQ(one.header, other.header);
  ASSERT_GT(one.rows, 0u);
  std::istringstream names(one.header);
  for (std::string name; std::getline(names, name, ',');) {
    if (name == time_column) continue;
    EXPECT_EQ(one.text(name), other.text(name)) << name;
  }
}

TEST(LibraryStudy, GivesTheCommandsTables) {
  const ScratchFolder folder;
  const fs::path out = folder / "library";
  fs::create_directories(out);
  run_command("study patterns --patterns e1 --estimators zncc --pairs 1 --radius-px 40 -q -o " +
              quoted(folder / "patterns"));
  Session session;
  PatternStudyRequest patterns;
  patterns.patterns = {"e1"};
  patterns.estimators = {"zncc"};
  patterns.pairs = 1;
  patterns.radius_px = 40;
  const PatternStudyResult found = study_patterns(patterns, session);
  EXPECT_EQ(found.findings.best_pattern, "e1");
  EXPECT_FALSE(found.device.name.empty());
  report::write_study(out, patterns, found);
  expect_same_table(out / "patterns.csv", folder / "patterns" / "patterns.csv", "ms_per_pair");

  run_command("study density --interp 1 --windows 3 --radius-px 40 -q -o " +
              quoted(folder / "density"));
  DensityStudyRequest density;
  density.most_points = 1;
  density.windows = 3;
  density.radius_px = 40;
  report::write_study(out, study_density(density, session));
  expect_same_table(out / "density.csv", folder / "density" / "density.csv", "us_per_window");
  for (const char* name : {"window.csv", "window_spline.csv"}) {
    expect_same_file(out / name, folder / "density" / name);
  }
}

}  // namespace
}  // namespace impactdic::testing
