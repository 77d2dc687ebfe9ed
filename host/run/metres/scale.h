// What follows from all rows of a run: the scale, and the impact in its units.
#pragma once

#include <impactdic/track.h>

#include <optional>
#include <string>

#include "host/clip/track_rows.h"
#include "host/motion/perspective.h"
#include "host/run/metres/impact_figures.h"

namespace impactdic::run {

// Sets scale and impact of `result` from `rows`, those measured. With the ball's diameter the scale
// is that over twice the free ball's radius: from the flights' frames alone, since a ball in
// contact is compressed. `sphere_radius_px`: of a sphere, where its turns tell it. `perspective`:
// of a sphere that was registered in it; none where the rows are those of a camera that looks
// squarely.
void conclude_metres(const TrackRequest& request, const std::optional<Measured>& sphere_radius_px,
                     const TrackRows& rows, TrackResult& result,
                     const motion::Perspective& perspective = {},
                     Impacts impacts = Impacts::kLookedFor);

// The same from the rows that the result holds.
void conclude_metres(const TrackRequest& request, const std::optional<Measured>& sphere_radius_px,
                     TrackResult& result);

// What makes a scale by the ball's diameter doubtful in a film of this kind; "" where nothing does.
std::string light_warning(const TrackRequest& request, const ClipInfo& clip);

}  // namespace impactdic::run
