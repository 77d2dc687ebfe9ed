// What a sphere's turns say of its rim.
#include "host/circle/sphere/rim_bias.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "host/circle/rim/rim_model.h"

namespace impactdic::testing {
namespace {

using circle::CircleFit;
using circle::RimBias;

std::shared_ptr<const circle::RimModel> rim_model(circle::Surface surface) {
  const auto model =
      std::make_shared<circle::RimModel>(circle::TextureSums(-0.3f).result(0.01), 0.0125, 0.9, 1.0);
  if (surface != circle::Surface::kFlat) model->set_surface(surface, {});
  return model;
}

CircleFit fit(double r_px, double chance_px, double shared_px) {
  CircleFit fit;
  fit.status = circle::CircleStatus::kOk;
  fit.circle = {200, 201, r_px};
  fit.cx_sd_px = fit.cy_sd_px = 0.02;
  fit.r_sd_px = std::hypot(chance_px, shared_px);
  fit.shared_r_sd_px = shared_px;
  fit.own_r_px = r_px;
  fit.rim_model = rim_model(circle::Surface::kSphere);
  return fit;
}

// Four frames whose rims are 0.12 px too large; turns tell the radius to 0.05 px.
constexpr std::array kRadii = {115.115, 115.125, 115.12, 115.13};
constexpr Measured kByTurns{115, 0.05};

TEST(RimBias, WhatTurnsTellIsTakenOffEveryRadiusAlike) {
  constexpr double kChance_px = 0.01, kShared_px = 0.1;
  const CircleFit like = fit(115.13, kChance_px, kShared_px);
  const auto bias = circle::rim_bias(kRadii, like, kByTurns);
  ASSERT_TRUE(bias);
  CircleFit first = fit(115.12, kChance_px, kShared_px),
            grown = fit(115.42, kChance_px, kShared_px);
  take_off(*bias, first);
  take_off(*bias, grown);
  // Weights by variances; half of a scatter of 0.0074 px is chance too, and of no account.
  const double told = 0.01 / (0.01 + 0.0025);
  EXPECT_NEAR(first.circle.r_px, 115.125 - told * 0.125 - 0.005, 2e-4);
  EXPECT_NEAR(grown.circle.r_px - first.circle.r_px, 0.3, 1e-9);  // as it was
  EXPECT_NEAR(first.r_sd_px, std::hypot(kChance_px, 0.1 * std::sqrt(1 - told)), 2e-4);
  EXPECT_EQ(first.circle.cx_px, 200);
  EXPECT_EQ(first.cx_sd_px, 0.02);
}

TEST(RimBias, ItIsThatOfOneKindOfRimModel) {
  const auto bias = circle::rim_bias(kRadii, fit(115.13, 0.01, 0.1), kByTurns);
  ASSERT_TRUE(bias);
  CircleFit flat = fit(115.12, 0.01, 0.1), crossings = flat, lost = flat;
  flat.rim_model = rim_model(circle::Surface::kFlat);
  crossings.rim_model = nullptr;
  lost.status = circle::CircleStatus::kNoBall;
  for (CircleFit* other : {&flat, &crossings, &lost}) {
    take_off(*bias, *other);
    EXPECT_EQ(other->circle.r_px, 115.12);
  }
  EXPECT_FALSE(circle::rim_bias(kRadii, crossings, kByTurns));
}

// Before wood circles were 0.7 px too large, five deviations, where the turns told better.
TEST(RimBias, OfRadiiThatContradictEachOtherEitherMayBeRight) {
  CircleFit circle = fit(115.13, 0.01, 0.1);
  const auto bias = circle::rim_bias(kRadii, circle, {114.5, 0.05});
  ASSERT_TRUE(bias);
  const double off = circle.circle.r_px - 114.5;
  take_off(*bias, circle);
  EXPECT_NEAR(circle.circle.r_px, 115.13 - off / 2, 0.03);
  EXPECT_GT(circle.r_sd_px, off / 2);
  EXPECT_LT(circle.r_sd_px, off);
  EXPECT_FALSE(circle::rim_bias({}, fit(115.13, 0.01, 0.1), kByTurns));
}

TEST(RimBias, ItGoesThroughNumbersUnchanged) {
  const auto bias = circle::rim_bias(kRadii, fit(115.13, 0.01, 0.1), kByTurns);
  ASSERT_TRUE(bias);
  EXPECT_EQ(RimBias(bias->numbers()).numbers(), bias->numbers());
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const auto& broken :
       {std::array{kNone, 0.1, 0.05, 1.0}, {0.1, 0.0, 0.05, 1.0}, {0.1, 0.1, -1.0, 1.0}}) {
    EXPECT_THROW(RimBias{broken}, InvalidArgument);
  }
}

}  // namespace
}  // namespace impactdic::testing
