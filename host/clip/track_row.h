// What `track` says of one frame, and its conversion from pixels to SI units.
#pragma once

#include <impactdic/track.h>

#include <cstddef>
#include <optional>

#include "host/clip/track_rows.h"

namespace impactdic {

// The row `i` of a track, `row` as it was measured: with its camera's correction and the depth of
// its flight. to_si(result, i) where `result` does not hold its rows.
SiRow to_si(const TrackResult& result, const TrackRow& row, std::size_t i);

// Where a row's rim has its centre, px, with the deviations. It errs by itself in every row, where
// centres by a sphere's turns err alike in many: paths are fitted to it.
struct RimCentre {
  double x_px, y_px, x_sd_px, y_sd_px;
};
RimCentre rim_centre(const TrackRow& row);

// Median radius of the rows with a circle; nullopt where there is none.
std::optional<double> median_radius_px(const TrackRows& rows);

}  // namespace impactdic
