#include "host/impact/flight_spin.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/base/statistics.h"

namespace impactdic::impact {

namespace {

// What one deviation of the camera's distance makes of a flight's turns in the picture's plane, on
// the mean.
double roll_to_nearness(const SphereSteps& steps, const FlightRange& range) {
  if (!(steps.nearness_sd() > 0)) return 0;
  double sum = 0;
  int count = 0;
  for (std::size_t i = range.first; i < range.last; ++i) {
    const SphereStep step = steps[i];
    if (step.ok) sum += step.roll_to_nearness, ++count;
  }
  return count > 0 ? sum / count * steps.nearness_sd() : 0.0;
}

}  // namespace

FlightSpin flight_spin(const ImpactSeries& series, const FlightRange& range) {
  std::vector<double> turns, sds;
  for (std::size_t i = range.first; i < range.last; ++i) {
    if (std::isfinite(series.turn(i))) {
      turns.push_back(series.turn(i));
      sds.push_back(series.turn_sd(i));
    }
  }
  if (turns.size() < 3) return {};
  const double usual = upper_median(finite(sds)), centre = upper_median(finite(turns));
  std::vector<double> off;
  for (double turn : turns) off.push_back(std::abs(turn - centre));
  const double limit = 5 * kSdOfMad * upper_median(finite(off)) + 1e-12;
  double weights = 0, sum = 0, squares = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (std::abs(turns[i] - centre) > limit) continue;
    const double sd = sds[i] > 0 ? sds[i] : usual > 0 ? usual : 1.0;
    weights += 1 / (sd * sd), sum += (turns[i] - centre) / (sd * sd), ++count;
  }
  if (count < 3) return {};
  const double mean = centre + sum / weights;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (std::abs(turns[i] - centre) > limit) continue;
    const double sd = sds[i] > 0 ? sds[i] : usual > 0 ? usual : 1.0;
    squares += (turns[i] - mean) * (turns[i] - mean) / (sd * sd);
  }
  const double scatter_sq = squares / static_cast<double>(count - 1);
  const double share = common_share(std::sqrt(scatter_sq), count);
  const double common = usual > 0 ? share * usual * usual : 0.0;
  const double by_nearness = series.sphere ? roll_to_nearness(*series.sphere, range) : 0.0;
  // Student's distribution of a mean whose scatter is known from few turns is wider (JCGM 101:2008,
  // section 6.4.9).
  const double freedom = std::max(static_cast<double>(count - 1), 3.0);
  const double wider = std::sqrt(freedom / (freedom - 2));
  return {mean, wider * std::sqrt(scatter_sq / weights),
          std::hypot(std::sqrt(common), by_nearness)};
}

}  // namespace impactdic::impact
