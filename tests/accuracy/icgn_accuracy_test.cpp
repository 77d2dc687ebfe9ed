// How exactly IC-GN windows measure rendered balls whose motion is known, and published pictures.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "host/dic/correlator.h"
#include "tests/support/data.h"
#include "tests/support/engine.h"
#include "tests/support/pictures.h"
#include "tests/support/speckle_frames.h"
#include "tests/support/window_truth.h"

namespace impactdic {
namespace {

using testing::read_picture;
using testing::shared_engine;

constexpr auto kOk = static_cast<idic_int>(WindowStatus::kOk);

std::vector<WindowMotion> measure(const FieldOptions& options, const Frame& first,
                                  const Frame& second, std::vector<Window>& windows) {
  const auto correlator = dic::make_opencl_correlator(shared_engine(), options, 2);
  correlator->set_frame(0, first);
  correlator->set_frame(1, second);
  for (Window& window : windows) window.second = 1;
  return correlator->correlate(windows);
}

// Errors of many windows, beside what noise alone makes and what the windows say of themselves.
struct Tally {
  double squares = 0, bound = 0, normalised = 0;
  double worst_px = 0, worst = 0;  // the latter in standard deviations
  int components = 0, lost = 0;

  void add(const testing::JudgedWindow& window) {
    if (!window.found()) {
      ++lost;
      return;
    }
    add(window.error_u, window.bound_u, window.got.u_sd);
    add(window.error_v, window.bound_v, window.got.v_sd);
  }
  void add(double error, double bound_sd, double sd) {
    squares += error * error;
    bound += bound_sd * bound_sd;
    normalised += error * error / (sd * sd);
    worst_px = std::max(worst_px, std::abs(error));
    worst = std::max(worst, std::abs(error) / sd);
    ++components;
  }
  double rms() const { return std::sqrt(squares / components); }
  double over_bound() const { return std::sqrt(squares / bound); }
  double over_sd() const { return std::sqrt(normalised / components); }
};

struct BallWindows {
  Tally whole, cut;
};

// Windows of 15 px on a ball in all eight motions.
BallWindows measure_motions(const std::string& pattern, std::uint64_t paint, double noise) {
  const sim::speckle::SpeckleBall ball = sim::speckle::paint_ball(pattern, paint);
  BallWindows tally;
  int seed = 0;
  for (const testing::PlaneMotion& motion : testing::kEightMotions) {
    for (const testing::JudgedWindow& window :
         testing::judge_windows(ball, motion, noise, ++seed)) {
      (window.cut ? tally.cut : tally.whole).add(window);
    }
  }
  return tally;
}

class IcgnOnBalls : public ::testing::TestWithParam<const char*> {};

TEST_P(IcgnOnBalls, WindowsOf15Pixels) {
  for (const double noise : {0.0, 2.0}) {
    const BallWindows tally = measure_motions(GetParam(), 1, noise);
    for (const auto& [what, sums] :
         {std::pair("whole", tally.whole), std::pair("cut", tally.cut)}) {
      std::printf("%s, noise %g, %s: rms %.5f px, over bound %.3f, over sd %.3f, lost %d of %d\n",
                  GetParam(), noise, what, sums.rms(), sums.over_bound(), sums.over_sd(), sums.lost,
                  sums.lost + sums.components / 2);
      EXPECT_EQ(sums.lost, 0) << what;
      if (noise > 0) {
        EXPECT_LE(sums.over_bound(), 1.10) << what;
        EXPECT_NEAR(sums.over_sd(), 1, 0.15) << what;
      }
    }
    EXPECT_LE(tally.whole.rms(), noise == 0 ? 0.0018 : 0.006);
  }
}
INSTANTIATE_TEST_SUITE_P(Patterns, IcgnOnBalls, ::testing::Values("e1", "f1", "a2", "a3", "b3"),
                         [](const auto& info) { return std::string(info.param); });

// Balls with few large speckles: most windows see nothing, or one edge along which they slide. They
// must say so, and none of the others may be wrong.
class IcgnOnSparseBalls : public ::testing::TestWithParam<const char*> {};

TEST_P(IcgnOnSparseBalls, NoWindowIsWrong) {
  for (const double noise : {0.0, 2.0}) {
    const BallWindows tally = measure_motions(GetParam(), 21, noise);
    for (const auto& [what, sums] :
         {std::pair("whole", tally.whole), std::pair("cut", tally.cut)}) {
      std::printf(
          "%s, noise %g, %s: rms %.5f px, worst %.3f px and %.1f sd, over sd %.3f, none in %d of "
          "%d\n",
          GetParam(), noise, what, sums.rms(), sums.worst_px, sums.worst, sums.over_sd(), sums.lost,
          sums.lost + sums.components / 2);
      // 0.07 px are allowed to be expected: four times that is no error of chance.
      EXPECT_LE(sums.worst_px, 0.3) << what;
      EXPECT_GT(sums.lost, 0) << what;
    }
    EXPECT_GT(tally.whole.components, 100);
    EXPECT_NEAR(tally.whole.over_sd(), 1, noise == 0 ? 0.25 : 0.15);
  }
}
INSTANTIATE_TEST_SUITE_P(Patterns, IcgnOnSparseBalls, ::testing::Values("d1", "d2", "d3"),
                         [](const auto& info) { return std::string(info.param); });

TEST(IcgnOnPictures, EveryWindowOfTheTranslation) {
  IMPACTDIC_NEED_DATA("speckle/Pattern_1.bmp");
  FieldOptions options;
  options.window_px = 31;
  options.search_px = 10;
  auto windows = dic::rectangle_grid(12, 12, 480, 480, 31, 12);
  const auto motions = measure(options, read_picture("speckle/Pattern_1.bmp"),
                               read_picture("speckle/Pattern_1_Translation.bmp"), windows);
  double worst = 0;
  for (const WindowMotion& motion : motions) {
    ASSERT_EQ(motion.status, kOk);
    worst = std::max({worst, std::abs(motion.u - 7.084), std::abs(motion.v - 7.084)});
  }
  std::printf("translation: worst of %zu windows %.5f px\n", motions.size(), worst);
  EXPECT_LE(worst, 0.01);
}

// Residual of the least-squares affine field through the displacements, both components.
double rms_about_affine(const std::vector<Window>& windows,
                        const std::vector<WindowMotion>& motions, double* worst) {
  double squares = 0;
  for (const bool second : {false, true}) {
    double normal[3][4] = {};
    const auto row = [&](std::size_t i) {
      return std::array<double, 4>{1, windows[i].x0 / 256.0 - 1, windows[i].y0 / 256.0 - 1,
                                   second ? motions[i].v : motions[i].u};
    };
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const auto r = row(i);
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 4; ++b) normal[a][b] += r[a] * r[b];
      }
    }
    for (int a = 0; a < 3; ++a) {  // Gauss–Jordan; the matrix is positive definite
      for (int other = 0; other < 3; ++other) {
        if (other == a) continue;
        const double factor = normal[other][a] / normal[a][a];
        for (int b = a; b < 4; ++b) normal[other][b] -= factor * normal[a][b];
      }
    }
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const auto r = row(i);
      double error = r[3];
      for (int a = 0; a < 3; ++a) error -= normal[a][3] / normal[a][a] * r[a];
      squares += error * error;
      *worst = std::max(*worst, std::abs(error));
    }
  }
  return std::sqrt(squares / (2.0 * static_cast<double>(windows.size())));
}

class IcgnOnAffinePictures : public ::testing::TestWithParam<const char*> {};

TEST_P(IcgnOnAffinePictures, FieldIsAffine) {
  const std::string file = std::string("speckle/Pattern_1_") + GetParam() + ".bmp";
  IMPACTDIC_NEED_DATA(file);
  FieldOptions options;
  options.window_px = 31;
  options.search_px = 30;
  auto windows = dic::rectangle_grid(45, 45, 420, 420, 31, 12);
  const auto motions =
      measure(options, read_picture("speckle/Pattern_1.bmp"), read_picture(file), windows);
  for (const WindowMotion& motion : motions) ASSERT_EQ(motion.status, kOk);
  double worst = 0;
  const double rms = rms_about_affine(windows, motions, &worst);
  std::printf("%s: rms %.5f px about an affine field, worst %.5f\n", GetParam(), rms, worst);
  EXPECT_LE(rms, 0.003);
}
INSTANTIATE_TEST_SUITE_P(Pictures, IcgnOnAffinePictures, ::testing::Values("Tension", "Shear"),
                         [](const auto& info) { return std::string(info.param); });

class IcgnOnSample14 : public ::testing::TestWithParam<const char*> {};

TEST_P(IcgnOnSample14, WindowsOf35Pixels) {
  IMPACTDIC_NEED_DATA("speckle/sample14/command.csv");
  // Columns: x, then displacement and strain of L1, L3 and L5.
  const std::size_t column = 1 + static_cast<std::size_t>(GetParam()[1] - '1');
  std::vector<double> truth;
  std::ifstream table(testing::data_path("speckle/sample14/command.csv"));
  for (std::string line; std::getline(table, line);) {
    std::stringstream cells(line);
    std::string cell;
    for (std::size_t k = 0; k <= column; ++k) std::getline(cells, cell, ',');
    truth.push_back(std::stod(cell));
  }
  FieldOptions options;
  options.window_px = 35;
  options.search_px = 4;
  const Frame first = read_picture("speckle/sample14/Sample14 Reference.tif");
  const Frame second =
      read_picture(std::string("speckle/sample14/Sample14 ") + GetParam() + " Amp0.1b.tif");
  auto windows = dic::rectangle_grid(10, 10, first.width() - 20, first.height() - 20, 35, 20);
  const auto motions = measure(options, first, second, windows);
  double squares = 0, bound = 0;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    ASSERT_EQ(motions[i].status, kOk);
    squares += std::pow(motions[i].u - truth[static_cast<std::size_t>(windows[i].x0) + 17], 2);
    bound += std::pow(motions[i].u_sd, 2);
  }
  const auto count = static_cast<double>(windows.size());
  std::printf("%s: rms %.5f px, noise alone %.5f\n", GetParam(), std::sqrt(squares / count),
              std::sqrt(bound / count));
  // The noise of these pictures alone (3.6 grey levels) allows 0.0117 px in windows of this size.
  EXPECT_LE(std::sqrt(squares / count), 1.10 * std::sqrt(bound / count));
  EXPECT_LE(std::sqrt(squares / count), 0.013);
}
INSTANTIATE_TEST_SUITE_P(Levels, IcgnOnSample14, ::testing::Values("L1", "L3", "L5"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace impactdic
