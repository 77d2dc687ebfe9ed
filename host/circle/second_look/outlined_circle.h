// A circle by its outline: where the picture leaves the background. Internal to host/circle.
#pragma once

#include <optional>

#include "host/circle/circle.h"
#include "host/circle/rim/rim_levels.h"

namespace impactdic::circle {

// Looks for the ball about a circle that may not be its own, as far as such a share of the radius
// scatters. For a circle: a bar's edge and an arc make a better ellipse than the ball's.
void look_about(const CircleFit& fit, double of_r, CirclePrior& prior, CircleOptions& options);

// Where the ball is expected, by single rays that leave the background clearly or, before an even
// background, by rays pooled with their neighbours; of as many points at least as `least_points` of
// CircleOptions::rays. nullopt where no outline shows.
std::optional<CircleFit> outlined_circle(const Frame& frame, const CirclePrior& prior,
                                         const CircleOptions& options, double least_points,
                                         LineTrace& lines);

// A circle outside of which something of a ball shows is not the ball's: the one whose outline lies
// about it, if less shows outside of that. Where no model of the rim tells, what is left is
// doubted, and of much there is no circle.
CircleFit with_all_inside(CircleFit fit, const Frame& frame, const CirclePrior& prior,
                          const CircleOptions& options, LineTrace& lines);

}  // namespace impactdic::circle
