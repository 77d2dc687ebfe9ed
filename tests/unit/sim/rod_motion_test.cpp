// The marker evaluation against markers painted on a rod whose motion is known.
#include "sim/rod/rod_motion.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <impactdic/units.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "host/base/parse.h"
#include "sim/rod/markers.h"
#include "sim/rod/rod_impact.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

constexpr double kRate_hz = 500, kGravity = 9.81;

// A rod held until it drops, falling, struck at `impact_s`, flying on until its other end lands.
struct Drop {
  double angle_deg = 45, speed_m_s = 2.487;
  double after_s = 0.06;
  double impact_s = 0.35123;
  double noise_m = 0;
  unsigned seed = 1;
  double turn_rad = 0.4;  // of the plane of motion about the vertical
  RodImpact rebound;
};

std::array<double, 3> centre_and_angle(const Drop& drop, double time) {
  const double release = drop.impact_s - drop.speed_m_s / kGravity;
  const double angle = drop.angle_deg * kRadPerDeg;
  const double t = time - drop.impact_s;
  if (time < release) {
    return {0, drop.speed_m_s * drop.speed_m_s / 2 / kGravity, angle};
  }
  if (t < 0) return {0, -drop.speed_m_s * t - kGravity * t * t / 2, angle};
  return {drop.rebound.vt_m_s * t, drop.rebound.vn_m_s * t - kGravity * t * t / 2,
          angle + drop.rebound.omega_rad_s * t};
}

MarkerTable paint(Drop& drop) {
  RodJob job = flexible_rod_preset();
  job.angle_rad = drop.angle_deg * kRadPerDeg;
  job.vn_m_s = -drop.speed_m_s;
  drop.rebound = sim::rod::simulate_rod(job);
  std::mt19937 random(drop.seed);
  std::normal_distribution<double> noise(0, 1);
  MarkerTable table;
  table.file = "painted";
  table.interval_s = 1 / kRate_hz;
  for (int i = 0; i / kRate_hz < drop.impact_s + drop.after_s; ++i) {
    const double time = i / kRate_hz;
    table.time_s.push_back(time);
    const auto [x, y, angle] = centre_and_angle(drop, time);
    for (std::size_t m = 0; m < 3; ++m) {
      const double along = 0.12 * (static_cast<double>(m) - 1);
      const double flat = x + along * std::cos(angle);
      table.markers[m].push_back(
          {1 + flat * std::cos(drop.turn_rad) + drop.noise_m * noise(random),
           0.5 + y + along * std::sin(angle) + drop.noise_m * noise(random),
           2 + flat * std::sin(drop.turn_rad) + drop.noise_m * noise(random)});
    }
  }
  return table;
}

TEST(RodMotion, RecoversANoiselessDropExactly) {
  for (double angle : {17.0, 45.0, 70.0}) {
    Drop drop;
    drop.angle_deg = angle;
    const MarkerTable table = paint(drop);
    const RodMeasurement m = sim::rod::measure_rod(table, {});
    EXPECT_NEAR(m.impact_s.value, drop.impact_s, 1e-6) << angle;
    EXPECT_NEAR(m.before.vn_m_s.value, -drop.speed_m_s, 1e-5);
    EXPECT_NEAR(m.after.vn_m_s.value, drop.rebound.vn_m_s, 1e-5);
    EXPECT_NEAR(m.after.vt_m_s.value, drop.rebound.vt_m_s, 1e-5);
    EXPECT_NEAR(m.after.omega_rad_s.value, drop.rebound.omega_rad_s, 1e-4);
    EXPECT_NEAR(m.before.angle_rad.value * kDegPerRad, angle, 1e-4);
    EXPECT_NEAR(m.before.gravity_m_s2.value, kGravity, 1e-3);
    EXPECT_NEAR(m.before.gravity_slope_m_s2, kGravity, 1e-2);
    EXPECT_LT(m.before.gravity_tilt_deg, 0.01);
    // The rod turns a little during the blow, which moves the lever: 0.01 of e.
    EXPECT_NEAR(m.restitution.value, drop.rebound.restitution, 0.012);
    EXPECT_EQ(m.closure.tangential_sign, 1);
  }
}

// The held rod is not free flight: the window must start at the release.
TEST(RodMotion, TheFitStopsAtTheReleaseAndAtTheSecondImpact) {
  Drop drop;
  drop.noise_m = 5e-5;
  const RodMeasurement m = sim::rod::measure_rod(paint(drop), {});
  const double release = drop.impact_s - drop.speed_m_s / kGravity;
  // Free fall leaves the rest position by 5 noises within two or three frames.
  EXPECT_NEAR(static_cast<double>(m.before.first) / kRate_hz, release, 0.012);
}

// Twenty camera noises: the stated deviations hold, and lines beat differences.
TEST(RodMotion, UncertaintiesAreHonestAndLinesBeatDifferences) {
  double pull = 0, line = 0, difference = 0;
  int count = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Drop drop;
    drop.noise_m = 1e-4;
    drop.seed = seed;
    const RodMeasurement m = sim::rod::measure_rod(paint(drop), {});
    const auto add = [&](const Measured& measured, double truth) {
      pull += std::pow((measured.value - truth) / measured.sd, 2);
      ++count;
    };
    add(m.after.vn_m_s, drop.rebound.vn_m_s);
    add(m.after.vt_m_s, drop.rebound.vt_m_s);
    add(m.after.omega_rad_s, drop.rebound.omega_rad_s);
    add(m.before.vn_m_s, -drop.speed_m_s);
    line += std::pow(m.after.vn_m_s.value - drop.rebound.vn_m_s, 2);
    difference += std::pow(m.after.difference_vn_m_s - drop.rebound.vn_m_s, 2);
  }
  // Chi-square of 160 terms, some shared: 1 +- 0.35 is four standard deviations.
  EXPECT_NEAR(pull / count, 1, 0.35);
  EXPECT_LT(line, 0.1 * difference);
}

TEST(RodMotion, AHiddenMarkerIsNamedAndNotMadeUp) {
  Drop drop;
  MarkerTable table = paint(drop);
  for (std::size_t i = 100; i < 105; ++i) table.markers[1][i] = {NAN, NAN, NAN};
  const RodMeasurement m = sim::rod::measure_rod(table, {});
  EXPECT_EQ(m.frames[102].status, "marker_2_hidden");
  EXPECT_TRUE(std::isnan(m.frames[102].qn_m));
  EXPECT_FALSE(std::isnan(m.frames[102].angle_rad));
  EXPECT_NEAR(m.after.vn_m_s.value, drop.rebound.vn_m_s, 1e-5);
}

TEST(RodMotion, TheVerticalAxisIsTheUsersChoice) {
  Drop drop;
  MarkerTable table = paint(drop);
  for (auto& marker : table.markers) {
    for (auto& p : marker) p = {p[0], p[2], -p[1]};
  }
  RodMeasureOptions options;
  options.vertical_axis = 2;
  options.vertical_down = true;
  const RodMeasurement m = sim::rod::measure_rod(table, options);
  EXPECT_NEAR(m.after.omega_rad_s.value, drop.rebound.omega_rad_s, 1e-4);
  EXPECT_NEAR(m.after.vt_m_s.value, drop.rebound.vt_m_s, 1e-5);
}

// Section 5.3's 45 degree shot: its printed tangential axis is turned round.
TEST(RodMotion, ClosureFindsTheFlippedAxisOfTheSource) {
  RodSide before, after;
  before.vt_m_s = {0.067, 0.005}, before.vn_m_s = {-2.487, 0.005};
  before.omega_rad_s = {0.02, 0.05}, before.angle_rad = {kPi / 4, 0};
  after.vt_m_s = {-0.14, 0.005}, after.vn_m_s = {-0.855, 0.005};
  after.omega_rad_s = {-19.67, 0.05}, after.angle_rad = {kPi / 4, 0};
  const RodClosure closure = sim::rod::close_impulses(RodBody{}, 0.13, before, after);
  EXPECT_NEAR(closure.omega_as_measured_rad_s.value, -25.8, 0.05);
  EXPECT_NEAR(closure.omega_axis_flipped_rad_s.value, -19.58, 0.005);
  EXPECT_EQ(closure.tangential_sign, -1);
  EXPECT_NEAR(closure.impulse_ratio.value, 0.207 / 1.632, 1e-12);
  EXPECT_TRUE(closure.inside_friction_cone);
}

TEST(RodMotion, ATableWithoutImpactIsRefused) {
  Drop drop;
  MarkerTable table = paint(drop);
  table.time_s.resize(150);
  for (auto& marker : table.markers) marker.resize(150);
  EXPECT_THROW(sim::rod::measure_rod(table, {}), FormatError);
}

class MarkerFile : public ::testing::Test {
 protected:
  std::string error_of(const std::string& contents) {
    const testing::ScratchFolder folder;
    const auto path = folder / "markers.csv";
    std::ofstream(path) << contents;
    std::string line = "accepted";
    try {
      sim::rod::read_markers(path);
    } catch (const Error& error) {
      line = error.line();
    }
    return line;
  }
  static std::string table(int rows, const std::string& special, int at) {
    std::string text = "time_s,x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,x3_m,y3_m,z3_m\n";
    for (int i = 0; i < rows; ++i) {
      text += i == at ? special + "\n" : shortest(i * 0.002) + ",0,0,0,1,1,0,2,2,0\n";
    }
    return text;
  }
};

TEST_F(MarkerFile, EveryFaultIsOneLineThatNamesThePlace) {
  EXPECT_EQ(error_of(table(20, "0.01,,,,1,1,0,2,2,0", 5)), "accepted");
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  };
  has(error_of("time_s,x1_m\n0,0\n"), "y1_m");
  has(error_of(table(20, "0.01,nan,0,0,1,1,0,2,2,0", 5)), "line 7, column x1_m");
  has(error_of(table(20, "0.01,0,,0,1,1,0,2,2,0", 5)), "marker 1");
  has(error_of(table(20, "0.011,0,0,0,1,1,0,2,2,0", 5)), "evenly");
  has(error_of(table(20, "0.01,0,0,0,1,1,0,2,2", 5)), "9 fields");
  has(error_of(table(20, "0.01,0,-3.7e28,0,1,1,0,2,2,0", 5)), "100 m");
  has(error_of(table(5, "", -1)), "5 rows");
  has(error_of(""), "empty");
}

}  // namespace
}  // namespace impactdic
