// Several shots: the scatter between them, its interval, and that of the value.
#include "sim/fit/pooling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sim/fit/calibration.h"
#include "sim/shot/track_table.h"
#include "tests/support/fitted_shots.h"

namespace impactdic {
namespace {

// Shots with a parameter drawn about 10, its deviations from 0.5 to 1.5 times `own`.
std::vector<ShotFit> drawn(std::mt19937_64& random, int count, double between, double own,
                           double per_m_s = 0) {
  std::normal_distribution<double> normal(0, 1);
  std::vector<ShotFit> shots;
  for (int i = 0; i < count; ++i) {
    ShotFit shot;
    shot.shot.before.vt_m_s.value = 0;
    shot.shot.before.vn_m_s.value = -2 - 0.5 * i;
    ParameterEstimate p;
    p.key = "stiffness";
    p.sd = own * (0.5 + static_cast<double>(i) / (count - 1));
    p.value = 10 + per_m_s * i * 0.5 + between * normal(random) + p.sd * normal(random);
    p.determined = true;
    shot.parameters = {p};
    shots.push_back(shot);
  }
  return shots;
}

struct Rates {
  double value = 0, between = 0, trend = 0;
};

Rates rates_of(int runs, int count, double between) {
  std::mt19937_64 random(17);
  Rates rates;
  for (int i = 0; i < runs; ++i) {
    const PooledEstimate p = sim::fit::pool(drawn(random, count, between, 1), 0, 3.5);
    rates.value += p.ci95_low <= 10 && 10 <= p.ci95_high;
    rates.between += p.between_ci95_low <= between && between <= p.between_ci95_high;
    rates.trend += !p.warnings.empty();
  }
  rates.value *= 100.0 / runs, rates.between *= 100.0 / runs, rates.trend *= 100.0 / runs;
  return rates;
}

TEST(Pooling, IntervalsHoldTheTruthAtTheRateTheyState) {
  for (const double between : {0.0, 0.7, 2.0}) {
    const Rates rates = rates_of(2000, 8, between);
    EXPECT_NEAR(rates.value, 95, 2.5) << between;
    // Without any scatter only its lower end can miss.
    EXPECT_NEAR(rates.between, between > 0 ? 95 : 97.5, 1.5) << between;
    EXPECT_LT(rates.trend, 1) << between;
  }
}

TEST(Pooling, ShotsThatAgreeHaveNoScatterBetweenThem) {
  std::mt19937_64 random(3);
  const PooledEstimate p = sim::fit::pool(drawn(random, 40, 0, 1), 0, 3.5);
  EXPECT_LT(p.between_sd, 0.6);
  EXPECT_NEAR(p.value, 10, 0.5);
  const PooledEstimate one = sim::fit::pool(drawn(random, 2, 0, 1), 0, 3.5);
  EXPECT_GT(one.ci95_high, one.ci95_low);
  std::vector<ShotFit> single = drawn(random, 2, 0, 1);
  single.pop_back();
  EXPECT_TRUE(std::isnan(sim::fit::pool(single, 0, 3.5).between_sd));
}

TEST(Pooling, AParameterThatChangesWithTheSpeedIsTold) {
  std::mt19937_64 random(5);
  const PooledEstimate p = sim::fit::pool(drawn(random, 12, 0, 0.3, 1.0), 0, 3.5);
  ASSERT_FALSE(p.trends.empty());
  EXPECT_EQ(p.trends[0].over, "speed_m_s");
  EXPECT_NEAR(p.trends[0].slope, 1, 4 * p.trends[0].sd);
  ASSERT_EQ(p.warnings.size(), 1u);
  EXPECT_NE(p.warnings[0].find("one value does not hold"), std::string::npos);
}

TEST(Pooling, AnErrorOfTheScaleDoesNotAverageOut) {
  std::mt19937_64 random(9);
  std::vector<ShotFit> shots = drawn(random, 16, 0, 0.1);
  for (ShotFit& shot : shots) {
    shot.parameters[0].scale_part = -0.5;
    shot.parameters[0].sd = std::hypot(shot.parameters[0].sd, 0.5);
  }
  const PooledEstimate p = sim::fit::pool(shots, 0, 3.5);
  EXPECT_GT(p.sd, 0.5);
  EXPECT_LT(p.sd, 0.52);
  EXPECT_LT(p.between_sd, 0.1);
}

// A Hertzian shot in memory whose lengths and times are off by these factors.
ShotFit hertz_fit(double length, double time, double scale_sd, double rate_sd, FitMethod method) {
  ImpactJob truth = testing::tennis_shot(0, 0, -3);
  truth.normal = NormalModel::kHertzDamper;
  truth.friction = FrictionModel::kNone;
  truth.contact.stiffness = 200000;
  truth.gravity_m_s2 = 0;
  testing::ScratchFolder folder;
  testing::SyntheticTrack track{truth};
  track.position_noise_m = 2e-6, track.stated_sd_m = 2e-6;
  write_track(track, folder / "track.csv");
  truth.contact.stiffness = truth.contact.damping_n_s_per_m = 0;
  FitRequest request;
  MeasuredTrack read = sim::shot::read_track(folder / "track.csv");
  for (auto* list : {&read.x_m, &read.y_m, &read.position_sd_m}) {
    for (double& v : *list) v *= length;
  }
  for (double& t : read.time_s) t *= time;
  read.interval_s *= time, read.metre_per_px *= length;
  read.scale_sd = scale_sd, read.rate_sd = rate_sd;
  request.shots = {{"", 0, read}};
  request.impact = truth;
  request.parameters = {FitParameter::kStiffness, FitParameter::kDamping};
  request.method = method;
  request.threads = 1;
  return sim::fit::calibrate(request).shots[0];
}

TEST(FitAccuracy, ScaleAndRateArePartsOfTheIntervals) {
  for (const FitMethod method : {FitMethod::kTrajectory, FitMethod::kRestitutionDuration}) {
    const ParameterEstimate exact = hertz_fit(1, 1, 0, 0, method).parameters[0];
    EXPECT_EQ(exact.scale_part, 0);
    const ParameterEstimate known = hertz_fit(1, 1, 0.01, 0.005, method).parameters[0];
    const double longer = hertz_fit(1.01, 1, 0, 0, method).parameters[0].value;
    const double slower = hertz_fit(1, 1.005, 0, 0, method).parameters[0].value;
    // Lengths 1 % longer: what an error of the scale of one deviation does.
    EXPECT_NEAR(known.scale_part, longer - exact.value, 0.05 * std::abs(longer - exact.value));
    EXPECT_NEAR(known.rate_part, slower - exact.value, 0.05 * std::abs(slower - exact.value));
    EXPECT_NEAR(known.sd, std::hypot(exact.sd, known.scale_part, known.rate_part), 0.02 * known.sd);
    EXPECT_GT(known.sd, 3 * exact.sd);
    EXPECT_NEAR(known.value, exact.value, 0.1 * exact.sd);
  }
}

}  // namespace
}  // namespace impactdic
