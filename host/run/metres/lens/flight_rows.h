// The rows of a track in which the ball flies freely.
#pragma once

#include <impactdic/impact.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "host/clip/track_rows.h"

namespace impactdic::run {

struct FlightRows {
  std::size_t first, last;
};

// Of those that were fitted, each of `fewest` frames or more; once where two of them are one.
inline std::vector<FlightRows> flights_of(const TrackRows& rows, const ImpactAnalysis& analysis,
                                          std::size_t fewest) {
  std::vector<FlightRows> flights;
  for (const FlightMotion* one : {&analysis.before, &analysis.after, &analysis.flight}) {
    if (one->last < one->first + fewest || one->last >= rows.size()) continue;
    const bool known = std::any_of(flights.begin(), flights.end(), [&](const FlightRows& flight) {
      return flight.first == one->first;
    });
    if (!known) flights.push_back({one->first, one->last});
  }
  return flights;
}

}  // namespace impactdic::run
