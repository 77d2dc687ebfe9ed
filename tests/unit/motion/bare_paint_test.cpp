// The light on a sphere of one paint with marks on it, by one picture.
#include "host/sphere/bare_paint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace impactdic::sphere {
namespace {

constexpr double kNoise = 1.5;

double level(const BallLight& light, const std::array<double, 3>& n) {
  const double facing = light.lamp[0] * n[0] + light.lamp[1] * n[1] + light.lamp[2] * n[2];
  return light.ambient + std::max(0.0, facing);
}

// A share of the places is marked with dark ink.
std::vector<SeenPaint> paint_under(const BallLight& light, double marked) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, kNoise);
  std::uniform_real_distribution<double> even(0, 1);
  std::vector<SeenPaint> paint;
  for (double x = -0.97; x < 0.97; x += 0.04) {
    for (double y = -0.97; y < 0.97; y += 0.04) {
      if (x * x + y * y > 0.93) continue;
      const std::array<double, 3> n{x, y, std::sqrt(1 - x * x - y * y)};
      const double ink = even(random) < marked ? 40 : 190;
      paint.push_back({n, ink * level(light, n) + normal(random)});
    }
  }
  return paint;
}

TEST(BarePaint, TellsTheLampBesideMarks) {
  const BallLight lamp{0.6F, {0.35F, -0.2F, 0.3F}, 0.02F};
  const auto told = light_on_bare_paint(paint_under(lamp, 0.2), kNoise);
  ASSERT_TRUE(told);
  // Only ratios count.
  const double unit = level(*told, {0, 0, 1}) / level(lamp, {0, 0, 1});
  for (const std::array<double, 3>& n :
       {std::array{0.7, -0.5, std::sqrt(0.26)}, std::array{-0.6, 0.6, std::sqrt(0.28)},
        std::array{0.1, 0.8, std::sqrt(0.35)}}) {
    EXPECT_NEAR(level(*told, n) / unit, level(lamp, n), 0.01);
  }
}

TEST(BarePaint, TellsNothingOfEvenLightOrOfMuchInk) {
  EXPECT_FALSE(light_on_bare_paint(paint_under({1, {0, 0, 0}, 0.02F}, 0.2), kNoise));
  EXPECT_FALSE(light_on_bare_paint(paint_under({0.6F, {0.35F, -0.2F, 0.3F}, 0.02F}, 0.5), kNoise));
}

}  // namespace
}  // namespace impactdic::sphere
