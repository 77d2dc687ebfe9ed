// The light on a sphere, by paint that a turn has carried through it.
#include "host/sphere/carried_paint.h"

#include <gtest/gtest.h>
#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace impactdic::sphere {
namespace {

struct Lamp {
  double share, elevation_deg, limb;
};
constexpr double kAzimuth = 2.1, kNoise = 1.2;

std::array<double, 3> direction(const Lamp& lamp) {
  const double up = lamp.elevation_deg * kRadPerDeg;
  return {std::cos(up) * std::cos(kAzimuth), std::cos(up) * std::sin(kAzimuth), std::sin(up)};
}

double level(const Lamp& lamp, const std::array<double, 3>& n) {
  const auto to = direction(lamp);
  const double facing = std::max(0.0, to[0] * n[0] + to[1] * n[1] + to[2] * n[2]);
  return (1 - lamp.share + lamp.share * facing) * (1 - lamp.limb * (1 - n[2]));
}

// A ball of two inks, turned by 25 degrees about the picture's vertical; a share of the places has
// changed otherwise, as beneath a glint.
std::vector<CarriedPaint> paint_under(const Lamp& lamp, double glint_share = 0) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, kNoise);
  std::uniform_real_distribution<double> even(0, 1);
  const double turn = 25 * kRadPerDeg;
  std::vector<CarriedPaint> paint;
  for (double x = -0.97; x < 0.97; x += 0.04) {
    for (double y = -0.97; y < 0.97; y += 0.04) {
      if (x * x + y * y > 0.94) continue;
      const double z = std::sqrt(1 - x * x - y * y);
      const std::array<double, 3> before{x, y, z};
      const std::array<double, 3> after{std::cos(turn) * x + std::sin(turn) * z, y,
                                        std::cos(turn) * z - std::sin(turn) * x};
      if (after[2] < 0.25) continue;
      const double ink = even(random) < 0.5 ? 60 : 200;
      double second = ink * level(lamp, after) + normal(random);
      if (even(random) < glint_share) second += 80;
      paint.push_back({before, after, ink * level(lamp, before) + normal(random), second});
    }
  }
  return paint;
}

void expect_lamp(const BallLight& light, const Lamp& lamp, double off) {
  const auto to = direction(lamp);
  const double whole = light.ambient + std::hypot(light.lamp[0], light.lamp[1], light.lamp[2]);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(light.lamp[k] / whole, lamp.share * to[k], off) << k;
  }
  EXPECT_NEAR(light.ambient / whole, 1 - lamp.share, off);
}

TEST(CarriedPaint, TellsTheLampAndTheAmbientLight) {
  for (const Lamp& lamp : {Lamp{0.9, 20, 0.3}, Lamp{0.5, 20, 0}, Lamp{0.7, 60, 0.3}}) {
    const auto light = light_on_paint(paint_under(lamp), kNoise);
    ASSERT_TRUE(light.has_value()) << lamp.share;
    expect_lamp(*light, lamp, 0.01);
  }
}

TEST(CarriedPaint, ATwentiethOfThePlacesBeneathGlintsHardlyMovesTheLamp) {
  const Lamp lamp{0.9, 20, 0.3};
  const auto light = light_on_paint(paint_under(lamp, 0.05), kNoise);
  ASSERT_TRUE(light.has_value());
  expect_lamp(*light, lamp, 0.02);
}

TEST(CarriedPaint, NoLampIsSeenInEvenLight) {
  EXPECT_FALSE(light_on_paint(paint_under({0, 0, 0}), kNoise).has_value());
  EXPECT_FALSE(light_on_paint(paint_under({0, 0, 0.4}), kNoise).has_value());
  EXPECT_FALSE(light_on_paint({}, kNoise).has_value());
}

}  // namespace
}  // namespace impactdic::sphere
