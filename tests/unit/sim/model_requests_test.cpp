// An impossible request is refused by the name of what is impossible.
#include <gtest/gtest.h>
#include <impactdic/compare.h>
#include <impactdic/error.h>
#include <impactdic/fit.h>
#include <impactdic/rod.h>
#include <impactdic/simulate.h>
#include <impactdic/study.h>
#include <impactdic/synth.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <variant>
#include <vector>

#include "sim/compare/compare_job.h"
#include "tests/support/racket_job.h"

namespace impactdic {
namespace {

std::string where_refused(const std::function<void()>& run) {
  try {
    run();
  } catch (const InvalidArgument& error) {
    return error.where();
  }
  return "accepted";
}

FitRequest racket_fit() {
  FitRequest request;
  request.impact = testing::racket_job();
  request.parameters = {FitParameter::kStiffness, FitParameter::kDamping};
  request.shots = {{"no_such_track.csv", 15, {}}};
  return request;
}

TEST(Requests, SimulateRefusesImpossibleValuesByName) {
  const auto simulating = [](const std::function<void(SimulateRequest&)>& change) {
    SimulateRequest request{testing::racket_job(), 0, {}};
    change(request);
    return where_refused([&] { simulate(request); });
  };
  EXPECT_EQ(simulating([](auto& r) { r.rate_hz = -1; }), "output.rate_hz");
  EXPECT_EQ(simulating([](auto& r) { r.impact.body.mass_kg = 0; }), "body.mass_kg");
  EXPECT_EQ(simulating([](auto& r) { r.times_s = {2, 1}; }), "times_s");
  EXPECT_EQ(simulating([](auto& r) { r.times_s = {1}, r.rate_hz = 1; }), "times_s");
}

TEST(Requests, FitRefusesImpossibleValuesByName) {
  const auto fitting = [](const std::function<void(FitRequest&)>& change) {
    FitRequest request = racket_fit();
    change(request);
    return where_refused([&] { fit(request); });
  };
  EXPECT_EQ(fitting([](auto& r) { r.shots.clear(); }), "tracks");
  EXPECT_EQ(fitting([](auto& r) { r.parameters.clear(); }), "fit.parameters");
  EXPECT_EQ(fitting([](auto& r) { r.flight_frames = 7; }), "fit.flight_frames");
  EXPECT_EQ(fitting([](auto& r) { r.outlier_sd = 0; }), "fit.outlier_sd");
  EXPECT_EQ(fitting([](auto& r) { r.grid.damping_steps = 4; }), "grid.damping_steps");
  EXPECT_EQ(fitting([](auto& r) { r.impact.body.diameter_m = -1; }), "body.diameter_m");
  EXPECT_EQ(fitting([](auto& r) { r.threads = -1; }), "threads");
  EXPECT_EQ(fitting([](auto& r) {
              r.impact.normal = NormalModel::kThornton;
              r.method = FitMethod::kPublishedGrid;
            }),
            "fit.method");
  EXPECT_EQ(fitting([](auto& r) {
              r.shots[0].in_memory = MeasuredTrack{};
              r.shots[0].in_memory->file = "mine";
            }),
            "mine");
}

TEST(Requests, TrackInMemoryNeedsAScale) {
  MeasuredTrack track;
  track.file = "mine";
  track.interval_s = 1e-4;
  for (int k = 0; k < 30; ++k) track.time_s.push_back(1e-4 * k);
  track.x_m = track.y_m = track.position_sd_m = track.time_s;
  track.dx_m = track.dy_m = track.motion_sd_m = track.turn_rad = track.turn_sd_rad = track.time_s;
  EXPECT_EQ(where_refused([&] { track.validate(); }), "mine");
  track.metre_per_px = 2.5e-4;
  EXPECT_EQ(where_refused([&] { track.validate(); }), "accepted");
}

TEST(Requests, CompareRefusesImpossibleValuesByName) {
  CompareRequest comparing = sim::compare::read_compare_job(
      std::filesystem::path(IMPACTDIC_SOURCE_DIR) / "sim" / "jobs" / "compare_wood.toml");
  comparing.formula.restitution = 1.5;
  EXPECT_EQ(where_refused([&] { compare(comparing); }), "formula.restitution");
  comparing.formula.restitution = kNotMeasured;
  comparing.models.clear();
  EXPECT_EQ(where_refused([&] { compare(comparing); }), "models");
  RodCompareRequest rods;
  rods.models = {"brody"};
  EXPECT_EQ(where_refused([&] { compare(rods); }), "models");
}

TEST(Requests, RodRefusesImpossibleValuesByName) {
  RodRequest rod;
  EXPECT_EQ(where_refused([&] { measure_rod(rod); }), "markers");
  rod.measure.body.mass_kg = -1;
  EXPECT_EQ(where_refused([&] { measure_rod(rod); }), "mass_kg");
}

TEST(Requests, SynthRefusesImpossibleValuesByName) {
  const auto painting = [](const std::function<void(SynthRequest&)>& change) {
    SynthRequest request;
    change(request);
    return where_refused([&] { synthesize(request, [](const Frame&) {}); });
  };
  EXPECT_EQ(painting([](auto& r) { r.radius_px = 5; }), "--radius-px");
  EXPECT_EQ(painting([](auto& r) { r.exposure = 2; }), "--exposure");
  EXPECT_EQ(painting([](auto& r) { r.hidden = -1; }), "--occlude");
  EXPECT_EQ(painting([](auto& r) { r.motion = GivenMotion{}; }), "--motion");
  EXPECT_EQ(painting([](auto& r) { r.motion = SimulatedMotion{}; }), "body.mass_kg");
  const double nan = std::nan("");
  EXPECT_EQ(painting([&](auto& r) { std::get<ConstantMotion>(r.motion).dx_px = nan; }), "motion");
  EXPECT_EQ(painting([&](auto& r) { std::get<ConstantMotion>(r.motion).start.z_px = nan; }),
            "motion");
  EXPECT_EQ(
      painting([&](auto& r) { r.motion = GivenMotion{std::vector<BallPose>(3, BallPose{nan})}; }),
      "--motion");
  EXPECT_EQ(painting([&](auto& r) { r.start = {nan, 0}; }), "--start-px");
}

TEST(Requests, StudyRefusesImpossibleValuesByName) {
  Session session;
  PatternStudyRequest patterns;
  patterns.pairs = 0;
  EXPECT_EQ(where_refused([&] { study_patterns(patterns, session); }), "--pairs");
  DensityStudyRequest density;
  density.most_points = 10;
  EXPECT_EQ(where_refused([&] { study_density(density, session); }), "--interp");
}

}  // namespace
}  // namespace impactdic
