// A circle by the rim model of earlier frames. Internal to host/circle.
#pragma once

#include <optional>

#include "host/circle/circle.h"
#include "host/circle/rim/rim.h"
#include "host/circle/rim/rim_levels.h"

namespace impactdic::circle {

// By the prior's rim model, where there is one and the prediction is near enough; nullopt where the
// rim has to be searched.
std::optional<CircleFit> follow(const Frame& frame, const CirclePrior& prior,
                                const CircleOptions& options, LineTrace& lines);

// By the prior's rim model of a disc, from the rim that the search found: where most edges hold ink
// its crossings may tell nothing, and a contact has changed the shape.
std::optional<CircleFit> follow_disc_from(const Rim& found, const Frame& frame, CirclePrior prior,
                                          const CircleOptions& options, LineTrace& lines);

// By the prior's rim model of a sphere, from where search or crossings found the rim. Crossings of
// the half level lie too far inside on a lit sphere, and on its dark side they may be wrong.
std::optional<CircleFit> follow_sphere_from(const Rim& found, const Frame& frame, CirclePrior prior,
                                            const CircleOptions& options, LineTrace& lines);

}  // namespace impactdic::circle
