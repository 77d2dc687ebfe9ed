// Flights of a ball in film so slow that gravity bends the path from frame to frame: a few centres
// each, and bounces that no frame shows. Internal to the impact analysis.
#pragma once

#include <vector>

#include "host/impact/flight_fit.h"
#include "host/impact/impact_series.h"

namespace impactdic::impact {

// Two flights that follow each other, and when their paths cross between them.
struct SparseBounce {
  FlightRange before, after;  // given at the crossing
  double change = 0;          // of the normal velocity, px/frame
};

// The bounces among the centres of `series`, that with the strongest change of the normal velocity
// first. A flight is at least four centres on a parabola that bends by far more than they scatter,
// by as much as the other flight's and towards the surface as gravity does (`gravity_n` < 0: its
// direction along the surface's normal). Between the flights the paths must cross, the one coming
// and the other going.
std::vector<SparseBounce> sparse_bounces(const ImpactSeries& series, double gravity_n);

}  // namespace impactdic::impact
