// An impact of a ball that was measured as a sphere: spin about three axes, slip and friction as
// vectors. Internal to the impact analysis.
#pragma once

#include "host/impact/impact_phases.h"

namespace impactdic::impact {

// What the spins about t and n add to the analysis of the plane motion in `plane`, in px, frames
// and rad; nullopt where they are not known.
//
// A contact at a point passes no moment about the normal and I d(omega_t) = -R J_b: the spin about
// t tells the friction across the plane. The velocity towards the camera is too uncertain to
// tell it; before the contact it is part of the slip, and taken for 0 where it is not known.
std::optional<SpaceImpact> space_impact(const ImpactOptions& options, const ImpactAnalysis& plane);

}  // namespace impactdic::impact
