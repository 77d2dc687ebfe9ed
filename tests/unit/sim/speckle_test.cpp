// Patterns, motion and noise of synthetic clips.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "sim/speckle/motion.h"
#include "sim/speckle/noise.h"
#include "sim/speckle/pattern.h"
#include "sim/speckle/render.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

namespace fs = std::filesystem;

class Patterns : public ::testing::TestWithParam<sim::speckle::PatternSpec> {};

// Figures of the dissertation's section 2.3, as measured on the rendered picture.
TEST_P(Patterns, HasTheStatedDensityAndArea) {
  const sim::speckle::PatternSpec& spec = GetParam();
  const sim::speckle::InkMeasure ink =
      sim::speckle::measure_ink(sim::speckle::paint_ball(spec.name, 20));
  EXPECT_NEAR(ink.density, spec.density, 0.005);
  if (spec.mean_area_px > 0) {
    const double tolerance = spec.name == std::string("a3") ? 0.13 : 0.05;
    EXPECT_NEAR(ink.mean_area_px / spec.mean_area_px, 1, tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Patterns, ::testing::ValuesIn(sim::speckle::pattern_specs()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(Pattern, RadiusChangesTheNumberOfSpecklesNotTheirSize) {
  const sim::speckle::SpeckleBall small = sim::speckle::paint_ball("b2", 1, 60),
                                  large = sim::speckle::paint_ball("b2", 1, 120);
  const auto on_it = [](const sim::speckle::SpeckleBall& ball) {
    return static_cast<double>(
        std::count_if(ball.discs.begin(), ball.discs.end(), [&](const sim::speckle::InkDisc& d) {
          return std::hypot(d.x_px, d.y_px) < ball.radius_px;
        }));
  };
  EXPECT_NEAR(on_it(large) / on_it(small), 4, 0.4);
  EXPECT_NEAR(sim::speckle::measure_ink(small).mean_area_px, 10, 0.5);
  EXPECT_NEAR(sim::speckle::measure_ink(large).mean_area_px, 10, 0.5);
}

// Dots packed up to an edge lie in layers along it: 0.07 of the surface was ink 0.7 px inside the
// rim of an a3 ball, and 0.46 of it 2 px inside.
TEST(Pattern, SpecklesLieBesideTheRimAsInside) {
  constexpr double kRadius = 60, kStep = 0.25;
  constexpr int kDepths = 6, kBalls = 8;  // px, and balls
  std::array<double, kDepths> ink{}, all{};
  for (std::uint64_t seed = 1; seed <= kBalls; ++seed) {
    const sim::speckle::SpeckleBall ball = sim::speckle::paint_ball("a3", seed, kRadius);
    for (double y = -kRadius; y < kRadius; y += kStep) {
      for (double x = -kRadius; x < kRadius; x += kStep) {
        const double depth = kRadius - std::hypot(x, y);
        if (depth < 0 || depth >= kDepths) continue;
        const bool dark = std::any_of(ball.discs.begin(), ball.discs.end(), [&](const auto& d) {
          return std::hypot(x - d.x_px, y - d.y_px) < d.radius_px;
        });
        ink[static_cast<std::size_t>(depth)] += dark;
        ++all[static_cast<std::size_t>(depth)];
      }
    }
  }
  for (std::size_t k = 0; k < kDepths; ++k) EXPECT_NEAR(ink[k] / all[k], 0.33, 0.06) << k << " px";
}

TEST(Pattern, SameSeedSameBallOtherSeedOtherBall) {
  const sim::speckle::SpeckleBall one = sim::speckle::paint_ball("f1", 9, 50),
                                  again = sim::speckle::paint_ball("f1", 9, 50);
  const sim::speckle::SpeckleBall other = sim::speckle::paint_ball("f1", 10, 50);
  ASSERT_EQ(one.discs.size(), again.discs.size());
  for (std::size_t i = 0; i < one.discs.size(); ++i) {
    EXPECT_EQ(one.discs[i].x_px, again.discs[i].x_px);
    EXPECT_EQ(one.discs[i].radius_px, again.discs[i].radius_px);
  }
  EXPECT_NE(one.discs[0].x_px, other.discs[0].x_px);
}

TEST(Pattern, LinesOnlyOnBallsF) {
  EXPECT_EQ(sim::speckle::paint_ball("f2", 1, 40).lines.size(), 5u);
  EXPECT_EQ(sim::speckle::paint_ball("f2", 1, 40).lines[0].width_px, 2);
  EXPECT_TRUE(sim::speckle::paint_ball("e2", 1, 40).lines.empty());
}

TEST(Pattern, RefusesUnknownNamesAndSizes) {
  EXPECT_THROW(sim::speckle::paint_ball("g1", 1), InvalidArgument);
  EXPECT_THROW(sim::speckle::paint_ball("a1", 1, 5), InvalidArgument);
  EXPECT_THROW(sim::speckle::paint_ball("a1", 1, std::nan("")), InvalidArgument);
}

struct Moments {
  double mean = 0, deviation = 0, kurtosis = 0;
};

Moments moments_of(const std::vector<double>& values) {
  Moments m;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) m.mean += v / n;
  double second = 0, fourth = 0;
  for (const double v : values) {
    second += std::pow(v - m.mean, 2) / n;
    fourth += std::pow(v - m.mean, 4) / n;
  }
  m.deviation = std::sqrt(second);
  m.kurtosis = fourth / (second * second);
  return m;
}

std::vector<double> noise_of(std::uint64_t seed, std::int64_t frame, int rows = 400) {
  std::vector<double> all(static_cast<std::size_t>(rows) * 501);
  for (int y = 0; y < rows; ++y) {
    sim::speckle::add_row_noise({all.data() + 501 * y, 501}, 2, seed, frame, y);
  }
  return all;
}

TEST(Noise, IsNormalWithTheStatedDeviation) {
  const std::vector<double> noise = noise_of(3, 17);
  const Moments m = moments_of(noise);
  const double root_n = std::sqrt(static_cast<double>(noise.size()));
  EXPECT_NEAR(m.mean, 0, 4 * 2 / root_n);  // four standard errors each
  EXPECT_NEAR(m.deviation, 2, 4 * 2 / (std::sqrt(2.0) * root_n));
  EXPECT_NEAR(m.kurtosis, 3, 4 * std::sqrt(24.0) / root_n);
}

TEST(Noise, IsIndependentFromFrameRowPixelAndSeed) {
  const std::vector<double> noise = noise_of(3, 17);
  const auto correlation = [&](const std::vector<double>& other, std::size_t shift) {
    double sum = 0;
    const std::size_t n = noise.size() - shift;
    for (std::size_t i = 0; i < n; ++i) sum += noise[i] * other[i + shift] / 4;
    return sum / static_cast<double>(n);
  };
  const double bound = 4 / std::sqrt(static_cast<double>(noise.size()) - 1000);
  EXPECT_NEAR(correlation(noise_of(3, 18), 0), 0, bound);
  EXPECT_NEAR(correlation(noise_of(4, 17), 0), 0, bound);
  EXPECT_NEAR(correlation(noise, 1), 0, bound);    // the next pixel
  EXPECT_NEAR(correlation(noise, 501), 0, bound);  // the next row
  EXPECT_EQ(noise, noise_of(3, 17));
}

class MotionFile : public ::testing::Test {
 protected:
  fs::path write(const std::string& text) const {
    std::ofstream(dir_ / "motion.csv") << text;
    return dir_ / "motion.csv";
  }
  testing::ScratchFolder dir_;
};

TEST_F(MotionFile, TruthHasTheStatedHeaderAndExactRows) {
  const std::vector<BallPose> poses =
      sim::speckle::constant_motion({{100.1, 200.2, 0}, 0.37, -0.61, 3}, 3);
  sim::speckle::write_truth_csv(dir_ / "truth.csv", poses, 115, 10000);
  std::ifstream in(dir_ / "truth.csv");
  std::stringstream text;
  text << in.rdbuf();
  EXPECT_EQ(text.str().substr(0, text.str().find('\n')),
            "frame,time_s,cx_px,cy_px,r_px,dx_px,dy_px,rot_deg");
  std::istringstream lines(text.str());
  std::string line;
  std::getline(lines, line);
  std::getline(lines, line);
  EXPECT_EQ(line.substr(0, 22), "0,0,100.1,200.2,115,0.");
  EXPECT_EQ(line.substr(line.rfind(',')), ",3");
  std::getline(lines, line);
  EXPECT_EQ(std::stod(line.substr(2)), 1e-4);
  std::getline(lines, line);
  EXPECT_EQ(line.substr(line.size() - 3), ",,,");
}

TEST_F(MotionFile, TruthReadsBackAsTheSameMotion) {
  const std::vector<BallPose> poses =
      sim::speckle::constant_motion({{100.1, 200.2, 0}, 0.37, -0.61, 3.3}, 40);
  sim::speckle::write_truth_csv(dir_ / "truth.csv", poses, 115, 10000);
  const std::vector<BallPose> read = sim::speckle::read_motion_csv(dir_ / "truth.csv").poses;
  ASSERT_EQ(read.size(), poses.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    EXPECT_EQ(read[k].cx_px, poses[k].cx_px);
    EXPECT_EQ(read[k].cy_px, poses[k].cy_px);
    EXPECT_NEAR(read[k].angle_deg, poses[k].angle_deg, 1e-12);  // summed from rot_deg
  }
}

TEST_F(MotionFile, StepsAreSummed) {
  const GivenMotion table =
      sim::speckle::read_motion_csv(write("dx_px,dy_px,rot_deg,compression,compression_axis_deg\n"
                                          "1,2,3,0,80\n0.5,0,-1,0.01,80\n,,,0.02,80\n"));
  const auto& poses = table.poses;
  EXPECT_FALSE(table.placed);
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_EQ(poses[0].cx_px, 0);
  EXPECT_EQ(poses[1].cx_px, 1);
  EXPECT_EQ(poses[2].cx_px, 1.5);
  EXPECT_EQ(poses[2].cy_px, 2);
  EXPECT_EQ(poses[2].angle_deg, 2);
  EXPECT_EQ(poses[2].compression, 0.02);
  EXPECT_EQ(poses[2].compression_axis_deg, 80);
}

TEST_F(MotionFile, DamagedFilesAreRefusedByLine) {
  EXPECT_THROW(sim::speckle::read_motion_csv(dir_ / "none.csv"), FileError);
  EXPECT_THROW(sim::speckle::read_motion_csv(write("")), FormatError);
  EXPECT_THROW(sim::speckle::read_motion_csv(write("a,b\n1,2\n")), FormatError);
  EXPECT_THROW(sim::speckle::read_motion_csv(write("cx_px,cy_px\n")), FormatError);
  EXPECT_THROW(sim::speckle::read_motion_csv(write("cx_px,cy_px\n1\n")), FormatError);
  EXPECT_THROW(sim::speckle::read_motion_csv(write("cx_px,cy_px\n1,\n")), FormatError);
  // A step in the middle that is empty leaves all later poses unknown.
  EXPECT_THROW(sim::speckle::read_motion_csv(write("dx_px,dy_px\n1,1\n,\n1,1\n")), FormatError);
  try {
    sim::speckle::read_motion_csv(write("cx_px,cy_px\n1,2\n1,x\n"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.line().find("line 3"), std::string::npos) << error.line();
  }
}

TEST(Motion, TruthIsThePoseAtMidExposure) {
  const std::vector<BallPose> poses = sim::speckle::constant_motion({{0, 0, 0}, 2, -4, 6}, 3);
  for (std::size_t k = 0; k < 3; ++k) {
    const sim::speckle::ShutterPath path = sim::speckle::shutter_path(poses, k, 0.5);
    EXPECT_DOUBLE_EQ(path.open.cx_px, poses[k].cx_px - 0.5);
    EXPECT_DOUBLE_EQ(path.close.cy_px, poses[k].cy_px - 1);
    EXPECT_DOUBLE_EQ(path.close.angle_deg, poses[k].angle_deg + 1.5);
  }
}

// What a sensor adds to its pixels is the same in every frame.
TEST(Render, FixedNoiseStandsStill) {
  SynthScene scene;
  scene.width = scene.height = 120;
  scene.fixed_noise_sigma = 3;
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("a1", 4, 30), scene);
  Frame first, second;
  renderer.render(BallPose{60, 60}, 0, first);
  renderer.render(BallPose{60, 60, 5}, 1, second);
  double squares = 0;
  int count = 0;
  for (int y = 0; y < 20; ++y) {  // beside the ball
    for (int x = 0; x < 120; ++x) {
      EXPECT_EQ(first.u8(x, y), second.u8(x, y));
      squares += std::pow(first.u8(x, y) - scene.background, 2);
      ++count;
    }
  }
  EXPECT_NEAR(std::sqrt(squares / count), 3, 0.15);
}

}  // namespace
}  // namespace impactdic
