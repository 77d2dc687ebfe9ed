// The parts of an analysis that looks for several impacts. Internal to the impact analysis.
#pragma once

#include "host/impact/impact_phases.h"

namespace impactdic::impact {

inline bool is_found(const ImpactAnalysis& analysis) {
  return analysis.status == ImpactStatus::kFound || analysis.status == ImpactStatus::kNotResolved;
}

// The sharpest impact on the side of the surface that n points to, or why there is none.
ImpactAnalysis impact_on_this_side(const TrackRows& rows, const ImpactOptions& options);

}  // namespace impactdic::impact
