// B-splines: kernels/spline.h and the host's reference against the definitions.
#include "kernels/spline.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <cmath>
#include <random>

#include "host/dic/frames/bspline.h"
#include "host/dic/frames/spline_taps.h"

namespace impactdic {
namespace {

class Spline : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degrees, Spline, ::testing::Values(3, 5, 7));

Image<double> random_picture(int width, int height) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> level(0, 255);
  Image<double> picture(width, height);
  for (std::size_t i = 0; i < picture.size(); ++i) picture.data()[i] = level(random);
  return picture;
}

TEST_P(Spline, KernelWeightsAreThoseOfTheRecursion) {
  for (double t = 0; t < 1; t += 0.03125) {
    float weights[8], slopes[8];
    spline_weights(GetParam(), static_cast<float>(t), weights);
    spline_slopes(GetParam(), static_cast<float>(t), slopes);
    const auto expected = dic::bspline_weights(GetParam(), t);
    const auto expected_slopes = dic::bspline_slopes(GetParam(), t);
    double sum = 0, slope_sum = 0;
    for (int j = 0; j <= GetParam(); ++j) {
      // A few roundings of single precision.
      EXPECT_NEAR(weights[j], expected[j], 2e-7);
      EXPECT_NEAR(slopes[j], expected_slopes[j], 5e-7);
      sum += weights[j];
      slope_sum += slopes[j];
    }
    EXPECT_NEAR(sum, 1, 4e-7);
    EXPECT_NEAR(slope_sum, 0, 1e-6);
  }
}

TEST_P(Spline, RecursionPartitionsUnityAndSlopesAreDerivatives) {
  constexpr double kStep = 1e-5;
  for (double t = 0.01; t < 0.99; t += 0.07) {
    const auto weights = dic::bspline_weights(GetParam(), t),
               slopes = dic::bspline_slopes(GetParam(), t);
    const auto low = dic::bspline_weights(GetParam(), t - kStep);
    const auto high = dic::bspline_weights(GetParam(), t + kStep);
    double sum = 0, mean = 0;
    for (int j = 0; j <= GetParam(); ++j) {
      sum += weights[j];
      mean += j * weights[j];
      EXPECT_NEAR(slopes[j], (high[j] - low[j]) / (2 * kStep), 1e-9);
    }
    EXPECT_NEAR(sum, 1, 1e-14);
    // Splines reproduce straight lines: the weights' centre is at t.
    EXPECT_NEAR(mean, (GetParam() - 1) / 2 + t, 1e-13);
  }
}

TEST_P(Spline, PassesThroughTheSamplesUpToTheBorder) {
  const auto picture = random_picture(23, 17);
  const dic::BSplineImage spline(picture, GetParam());
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      ASSERT_NEAR(spline.value(x, y), picture(x, y), 1e-10);
    }
  }
}

TEST_P(Spline, SlopesAreDerivativesOfTheValue) {
  const dic::BSplineImage spline(random_picture(20, 20), GetParam());
  constexpr double kStep = 1e-5;
  for (double x = 0.3; x < 19; x += 2.71) {
    const double y = 18.9 - 0.9 * x;
    const auto sample = spline.sample(x, y);
    EXPECT_NEAR(sample.slope_x,
                (spline.value(x + kStep, y) - spline.value(x - kStep, y)) / (2 * kStep), 1e-5);
    EXPECT_NEAR(sample.slope_y,
                (spline.value(x, y + kStep) - spline.value(x, y - kStep)) / (2 * kStep), 1e-5);
  }
}

// The taps of the kernel and the recursive filter are two ways to the same coefficients.
TEST_P(Spline, TapsAreTheRecursiveFilter) {
  for (const double sigma : {0.0, 0.5, 0.8}) {
    const auto taps = dic::prefilter_taps(GetParam(), sigma);
    const int radius = static_cast<int>(taps.size()) - 1;
    Image<double> impulse(161, 1);
    impulse(80, 0) = 1;
    const dic::BSplineImage spline(impulse, GetParam(), sigma);
    for (int x = 0; x < 161; ++x) {
      const int distance = std::abs(x - 80);
      EXPECT_NEAR(spline.coefficient(x, 0), distance <= radius ? taps[distance] : 0.0, 1e-8) << x;
    }
  }
}

TEST_P(Spline, NoiseGainHoldsBetweenItsNodes) {
  for (const double sigma : {0.0, 0.5}) {
    const auto noise = dic::interpolation_noise(GetParam(), sigma);
    const auto taps = dic::prefilter_taps(GetParam(), sigma, 1e-12);
    for (double t = 0; t < 1; t += 0.0625) {
      const auto weights = dic::bspline_weights(GetParam(), t);
      double variance = 0;
      for (int sample = -60; sample <= 60; ++sample) {
        double share = 0;
        for (int j = 0; j <= GetParam(); ++j) {
          const auto distance = static_cast<std::size_t>(std::abs(sample - j));
          if (distance < taps.size()) share += weights[j] * taps[distance];
        }
        variance += share * share;
      }
      const double c = std::cos(2 * M_PI * t);
      EXPECT_NEAR(noise[0] + noise[1] * c + noise[2] * c * c, variance, 0.003);
    }
    if (sigma == 0) {
      EXPECT_NEAR(noise[0] + noise[1] + noise[2], 1, 1e-9);
    }
  }
}

TEST(SplineTaps, RefuseOtherDegrees) {
  EXPECT_THROW(dic::prefilter_taps(4, 0), InvalidArgument);
  EXPECT_THROW(dic::prefilter_taps(5, -1), InvalidArgument);
}

}  // namespace
}  // namespace impactdic
