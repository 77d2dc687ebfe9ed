// One value of a parameter out of several shots.
#pragma once

#include <vector>

#include "sim/fit/calibration.h"

namespace impactdic::sim::fit {

// Parameter `index` of every shot, as impactdic::PooledEstimate says.
PooledEstimate pool(const std::vector<ShotFit>& shots, std::size_t index, double outlier_sd);

// Of values with known deviations: the deviation between them beyond these (restricted maximum
// likelihood, 0 where they agree), and its 95 % interval by the generalised Q statistic. At least
// two values.
struct Between {
  double sd = 0, ci95_low = 0, ci95_high = 0;
};
Between scatter_between(const std::vector<double>& values, const std::vector<double>& sds);

}  // namespace impactdic::sim::fit
