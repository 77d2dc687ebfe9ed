// A sphere's registrations against keyframes as data of a flight. A step from frame to frame knows
// as little of a flight's motion as it is short; all frames that lean on one keyframe know where
// they are against it, as well as a step does. Internal to the impact analysis.
#pragma once

#include <vector>

#include "host/impact/flight/flight_data.h"

namespace impactdic::impact {

// Rows about places and turns (kShift, kTilt, kRoll) of flight number `flight`. Each keyframe has
// three groups of its own from `first_group` on. Of a keyframe in the flight the path itself says
// how far from the ball's centre it was registered, and what that does to the motion
// (sphere::source_response); of one before the flight nothing but how the frames that lean on it
// moved among themselves is used. Of a flat ball: flat_links. Empty where too few of the flight's
// frames were registered.
std::vector<Datum> flight_links(const ImpactSeries& series, const GravityDirection& direction,
                                const FlightRange& range, int flight, int first_group);

}  // namespace impactdic::impact
