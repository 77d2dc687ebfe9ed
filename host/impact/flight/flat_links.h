// A flat ball's registrations against keyframes as data of a flight. A mean of steps adds up what
// they have alike; places on one keyframe err independently. Internal to the impact analysis.
#pragma once

#include <vector>

#include "host/impact/flight/flight_data.h"

namespace impactdic::impact {

// Rows about places (kShift) of flight number `flight`, along t and n: where the point of the ball
// is that was taken for its centre in the first frame, which turns about the centre. Each keyframe
// has two groups of its own from `first_group` on. Empty where too few of the flight's frames lean
// on keyframes.
std::vector<Datum> flat_links(const ImpactSeries& series, const GravityDirection& direction,
                              const FlightRange& range, int flight, int first_group);

// The largest deviation of a circle that poses of the flight lead back to, px; 0 where none has
// one.
double followed_sd(const ImpactSeries& series, const FlightRange& range);

}  // namespace impactdic::impact
