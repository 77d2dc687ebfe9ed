// What `track` says of one frame, and its conversion from pixels to SI units.
#pragma once

#include <impactdic/track.h>

#include <optional>
#include <vector>

namespace impactdic {

// Median radius of the rows with a circle; nullopt where there is none. The dissertation's scale
// (section 3.2.1) is the ball's diameter over the mean one; the median stands a ball that is
// compressed for a while.
std::optional<double> median_radius_px(const std::vector<TrackRow>& rows);

}  // namespace impactdic
