#include "sim/fit/residuals/residual_weights.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace impactdic::sim::fit {
namespace {

constexpr std::size_t kWindow = 25;  // frames: about half of a flight, or of a contact
constexpr std::size_t kFewest = 20;  // a shorter series tells nothing about correlation

// Sum over lags of the autocovariance about zero, times the number of values.
double long_run_sum(const std::vector<double>& series) {
  double sum = 0;
  const std::size_t window = std::min(kWindow, series.size() / 4 + 1);
  for (std::size_t lag = 0; lag < window; ++lag) {
    double product = 0;
    for (std::size_t i = lag; i < series.size(); ++i) product += series[i] * series[i - lag];
    const double share = 1 - static_cast<double>(lag) / static_cast<double>(window);
    sum += (lag == 0 ? 1 : 2) * share * product;
  }
  return sum;
}

}  // namespace

DeviationFactors deviation_factors(const ShotModel& model,
                                   std::span<const double> stated_residuals) {
  DeviationFactors factors;
  for (std::size_t kind = 0; kind < kMeasurementKinds; ++kind) {
    double sum = 0, count = 0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      std::vector<double> series;
      for (std::size_t r = 0; r < stated_residuals.size(); ++r) {
        const MeasurementSeries at = model.series_of(r);
        if (static_cast<std::size_t>(at.kind) == kind && at.axis == axis) {
          series.push_back(stated_residuals[r]);
        }
      }
      sum += long_run_sum(series), count += static_cast<double>(series.size());
    }
    factors[kind] = count >= kFewest ? std::sqrt(std::max(1.0, sum / count)) : 1;
  }
  return factors;
}

}  // namespace impactdic::sim::fit
