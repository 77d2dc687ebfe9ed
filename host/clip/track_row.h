// What `track` says of one frame, and its conversion from pixels to SI units.
#pragma once

#include <impactdic/track.h>

#include <optional>
#include <vector>

namespace impactdic {

// Median radius of the rows with a circle; nullopt where there is none.
std::optional<double> median_radius_px(const std::vector<TrackRow>& rows);

}  // namespace impactdic
