#include "host/dic/frames/spline_taps.h"

#include <impactdic/error.h>

#include <array>
#include <cmath>
#include <numbers>

#include "host/dic/frames/bspline.h"

namespace impactdic::dic {

void check_spline(int degree, double presmooth_sigma_px) {
  if (degree != 3 && degree != 5 && degree != 7) {
    throw InvalidArgument("the degree of the spline must be 3, 5 or 7");
  }
  if (!(presmooth_sigma_px >= 0 && presmooth_sigma_px <= 3)) {
    throw InvalidArgument("the smoothing must lie in 0 … 3 px");
  }
}

std::vector<double> gaussian_taps(double sigma_px) {
  if (sigma_px <= 0) return {1.0};
  std::vector<double> taps(static_cast<std::size_t>(std::ceil(4 * sigma_px)) + 1);
  double sum = 0;
  for (std::size_t k = 0; k < taps.size(); ++k) {
    taps[k] = std::exp(-0.5 * std::pow(static_cast<double>(k) / sigma_px, 2));
    sum += k == 0 ? taps[k] : 2 * taps[k];
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

namespace {

// Σ taps[|k|] cos(k ω): what a symmetric filter does to the frequency ω.
double response(const std::vector<double>& taps, double omega) {
  double sum = taps[0];
  for (std::size_t k = 1; k < taps.size(); ++k) {
    sum += 2 * taps[k] * std::cos(static_cast<double>(k) * omega);
  }
  return sum;
}

// Variance of Σ weights[j] c(j) for white noise of variance 1 in the samples that `taps` turn into
// the coefficients c.
double variance_of(const std::array<double, 8>& weights, int degree,
                   const std::vector<double>& taps) {
  const int radius = static_cast<int>(taps.size()) - 1;
  double sum = 0;
  for (int sample = -radius; sample <= radius + degree; ++sample) {
    double share = 0;
    for (int j = 0; j <= degree; ++j) {
      const int distance = std::abs(sample - j);
      if (distance <= radius) share += weights[j] * taps[distance];
    }
    sum += share * share;
  }
  return sum;
}

}  // namespace

std::vector<double> prefilter_taps(int degree, double presmooth_sigma_px, double tolerance) {
  check_spline(degree, presmooth_sigma_px);
  const auto smooth = gaussian_taps(presmooth_sigma_px);
  const auto weights = bspline_weights(degree, 0.0);
  const int reach = (degree - 1) / 2;
  const std::vector<double> spline(weights.begin() + reach, weights.begin() + degree);
  // The inverse of the spline's response, on a circle so long that its ends do not meet: the
  // slowest pole of degree 7 falls by 0.535 a pixel.
  constexpr std::size_t kLength = 256;
  std::array<double, kLength> cosines;
  for (std::size_t k = 0; k < kLength; ++k) {
    cosines[k] = std::cos(2 * std::numbers::pi * static_cast<double>(k) / kLength);
  }
  std::vector<double> taps(kLength / 2, 0.0);
  for (std::size_t bin = 0; bin < kLength; ++bin) {
    const double omega = 2 * std::numbers::pi * static_cast<double>(bin) / kLength;
    const double ratio = response(smooth, omega) / response(spline, omega);
    for (std::size_t k = 0; k < taps.size(); ++k) {
      taps[k] += ratio * cosines[bin * k % kLength] / kLength;
    }
  }
  double beyond = 0;
  while (taps.size() > 1 && beyond + 2 * std::abs(taps.back()) < tolerance) {
    beyond += 2 * std::abs(taps.back());
    taps.pop_back();
  }
  return taps;
}

std::array<double, 3> interpolation_noise(int degree, double presmooth_sigma_px) {
  const auto taps = prefilter_taps(degree, presmooth_sigma_px, 1e-12);
  const auto variance = [&](double t) {
    return variance_of(bspline_weights(degree, t), degree, taps);
  };
  const double at_pixel = variance(0), quarter = variance(0.25), middle = variance(0.5);
  return {quarter, (at_pixel - middle) / 2, (at_pixel + middle) / 2 - quarter};
}

double slope_noise(int degree) {
  return variance_of(bspline_slopes(degree, 0), degree, prefilter_taps(degree, 0, 1e-12));
}

}  // namespace impactdic::dic
