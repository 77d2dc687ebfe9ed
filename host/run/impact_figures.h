// The impact of a track, in the units that people read.
#pragma once

#include <impactdic/track.h>

#include <vector>

namespace impactdic::run {

// Analyses the impact in `rows`, and converts what it found to frames of the stored file, seconds
// and metres as far as `scale` knows them. Gravity's strength is known where scale and rate are.
void analyse_impact(const TrackRequest& request, const std::vector<TrackRow>& rows,
                    const SiScale& scale, ImpactAnalysis& analysis, ImpactFigures& figures);

}  // namespace impactdic::run
