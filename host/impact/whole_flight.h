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

// What both flights of `result` do out of the picture's plane: a sphere's spins about t and n, and
// the velocity along b.
void put_out_of_plane(const FlightFit& fit, const TrackRows& rows, const ImpactOptions& options,
                      ImpactAnalysis& result);

// The velocity towards the camera, px/frame: of an outline that grows. A ball of radius R at the
// distance D shows the radius f R / sqrt(D^2 - R^2). NaN where the distance is not known.
Measured towards_camera(const TrackRows& rows, const FlightRange& range,
                        const ImpactOptions& options, double radius_px);

// What the rows of a sphere were measured with.
SphereKnown known_of_sphere(const ImpactOptions& options);

// The motion of a ball that flies freely in all of `rows`, in their middle; `last` 0 where it does
// not, or where rows are too few to tell.
FlightMotion whole_flight(const TrackRows& rows, const ImpactOptions& options);

}  // namespace impactdic::impact
