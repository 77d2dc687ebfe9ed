// How many errors that follow each other count as one. Internal to the impact analysis.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace impactdic::impact {

// Of so many independent errors one in a thousand has a correlation that large.
inline double beyond_chance(double count) { return 3 / std::sqrt(count); }

// The sum of the correlations of residuals (Sokal 1997) that follow each other within each of
// `runs`, for as many frames as they are larger than `least`: 1 where they are independent.
inline double alike_in_a_row(std::span<const std::vector<double>> runs, double least) {
  double variance = 0, sum = 0;
  for (const std::vector<double>& run : runs) {
    for (const double x : run) variance += x * x;
  }
  for (std::size_t lag = 1;; ++lag) {
    double products = 0;
    bool any = false;
    for (const std::vector<double>& run : runs) {
      for (std::size_t i = 0; i + lag < run.size(); ++i)
        products += run[i] * run[i + lag], any = true;
    }
    if (!any || !(products > least * variance)) break;
    sum += products / variance;
  }
  return 1 + 2 * sum;
}

}  // namespace impactdic::impact
