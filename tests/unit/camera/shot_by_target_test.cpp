// Figures in SI whose scale, lens and tilt are known by a calibration alone: their 95 % intervals.
#include "tests/support/camera/shot_by_target.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

namespace impactdic::testing {
namespace {

constexpr double kNormal95 = 1.959964;

// Shots with a camera and a calibration of its own each, which is as good as few, poor pictures
// make it: the camera's part is most of many deviations. IMPACTDIC_SHOTS=400 settles a coverage
// to 1.1 %.
TEST(ShotByTarget, IntervalsHold) {
  const char* wanted = std::getenv("IMPACTDIC_SHOTS");
  const int shots = wanted != nullptr ? std::atoi(wanted) : 12;
  CalibrationPlan plan;
  plan.fewest_pictures = 5, plan.most_pictures = 10;
  plan.points_sd_px = 0.05;
  std::mt19937_64 random(4713);
  struct Score {
    int inside = 0;
    double squares = 0;
  };
  std::map<std::string, Score> scores;
  double most_of_camera = 0;
  for (int i = 0; i < shots; ++i) {
    ShotByTarget by = shot_by_target_of(random, plan);
    by.conclude();
    const ImpactFigures& found = by.shot.result.impact_si;
    ASSERT_EQ(found.status, ImpactStatus::kFound) << "shot " << i;
    EXPECT_TRUE(found.contradictions.empty()) << found.contradictions[0].message << ", shot " << i;
    each_figure(by.shot, [&](const char* name, const Measured& m, double truth) {
      const double off = (m.value - truth) / m.sd;
      scores[name].inside += std::abs(off) <= kNormal95;
      scores[name].squares += off * off;
    });
    const double camera =
        found.budget(ImpactFigure::kVnBefore)[static_cast<std::size_t>(ErrorSource::kCamera)];
    most_of_camera = std::max(most_of_camera, camera / found.before.vn.sd);
  }
  EXPECT_GT(most_of_camera, 0.7);
  // Chance alone moves each by sqrt(0.95 * 0.05 / shots).
  const double chance = std::sqrt(0.95 * 0.05 / shots);
  double all = 0;
  for (const auto& [name, score] : scores) {
    const double share = score.inside / static_cast<double>(shots);
    std::printf("%-14s %.1f %%, error over stated %.2f\n", name.c_str(), 100 * share,
                std::sqrt(score.squares / shots));
    EXPECT_GE(share, 0.95 - 3 * chance) << name;
    all += share / static_cast<double>(scores.size());
  }
  EXPECT_NEAR(all, 0.95, 2 * chance);
}

// The whole way once, from pictures of a target.
TEST(ShotByTarget, PicturesOfATargetTellTheFigures) {
  CalibrationPlan plan;
  plan.fewest_pictures = plan.most_pictures = 5;
  std::mt19937_64 random(12);
  ShotByTarget by = shot_by_target_of(random, plan);
  by.conclude();
  ASSERT_EQ(by.shot.result.impact_si.status, ImpactStatus::kFound);
  each_figure(by.shot, [](const char* name, const Measured& m, double truth) {
    EXPECT_NEAR(m.value, truth, 3.5 * m.sd) << name;
    EXPECT_GT(m.sd, 0) << name;
  });
}

}  // namespace
}  // namespace impactdic::testing
