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

// Of a flat ball whose frames lean on keyframes, the slope of its angles: they err independently
// where turns that follow each other add up what they have alike, as a pattern that stands still on
// the sensor, or a bar's edge. Else the weighted mean of a flight's turns. What is off by more than
// five deviations is left out.
FlightSpin flight_spin(const ImpactSeries& series, const FlightRange& range);

}  // namespace impactdic::impact
