// The spin of a flight. Internal to the impact analysis.
#pragma once

#include "host/impact/flight_fit.h"

namespace impactdic::impact {

// rad/frame; NaN where fewer than three turns are known.
struct FlightSpin {
  double value = kNotMeasured;
  double noise_sd = kNotMeasured;   // from the scatter of the turns
  double common_sd = kNotMeasured;  // what they may have in common
};

// Weighted mean of a flight's turns; those off by more than five deviations are left out.
FlightSpin flight_spin(const ImpactSeries& series, const FlightRange& range);

}  // namespace impactdic::impact
