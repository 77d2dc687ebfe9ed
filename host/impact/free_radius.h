// The radius of the ball while nothing touches it: what a scale by its diameter rests on. Internal
// to the impact analysis.
#pragma once

#include <vector>

#include "host/clip/track_rows.h"
#include "host/impact/flight_fit.h"

namespace impactdic::impact {

struct FreeRadius {
  Measured px;
  std::size_t frames = 0;       // that it is the mean of
  double drift = kNotMeasured;  // px: of the second flight less the first
};

// Weighted mean over the two flights; a frame that is off by more than five times the scatter is
// left out. The deviation holds three things: what the stated deviations say beyond the scatter (a
// rim with ink errs in every frame alike), the scatter over the number of frames, and half the
// difference of the flights, which the scatter within one does not show.
FreeRadius free_radius(const TrackRows& rows, const FlightRange& before, const FlightRange& after);

// By how much the ball's outline grows a frame, in proportion to its size: the slope of a line
// through the radii of `range`. The deviation is that of their scatter, in which errors that are
// alike in a row count as fewer, and of a drift over the whole range, as of a texture that turns
// under the rim. NaN of fewer than twelve circles.
Measured radius_growth(const TrackRows& rows, const FlightRange& range);

// Of a clip without an impact: the halves of `rows`, about the median.
FreeRadius free_radius(const TrackRows& rows);

}  // namespace impactdic::impact
