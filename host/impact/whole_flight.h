// A sphere's spins, and a track that is one flight from end to end. Internal to the
// impact analysis.
#pragma once

#include <optional>
#include <vector>

#include "host/impact/flight_fit.h"
#include "host/impact/impact_phases.h"

namespace impactdic::impact {

// What a turn out of the picture's plane may make of the spin towards the camera, rad/frame; 0 of a
// flat ball. `first`: of the flight's spins.
double tilted_spin_sd(const FlightFit& fit, SphereSpin first);

// A sphere's spins about t and n; `first` is the component about t (SphereSpin).
void put_spins(const FlightFit& fit, SphereSpin first, FlightMotion& motion);

// Of a sphere's radius, as the rows' deviations have it; nullopt where it is not known.
std::optional<double> sphere_radius_sd_px(const ImpactOptions& options);

// The motion of a ball that flies freely in all of `rows`, in their middle; `last` 0 where it does
// not, or where rows are too few to tell.
FlightMotion whole_flight(const std::vector<TrackRow>& rows, const ImpactOptions& options);

}  // namespace impactdic::impact
