// What speaks for a circle's being the ball's, and what against. Internal to host/circle.
#pragma once

#include <optional>

#include "host/circle/circle.h"

namespace impactdic::circle {

// Share of the rim in view that carried the fit.
double rim_in_view(const CircleFit& fit, const Frame& frame);

bool is_round(const CircleFit& fit);

// The model of a disc's rim.
bool is_flat(const RimModel* model);

// The circle is the ball's as far as its radius tells.
bool is_plausible(const CircleFit& fit, const std::optional<double>& radius_px);

// Whether a circle is larger than a ball grows from a frame to the next: a shadow beside it, or
// another thing, is taken in.
bool is_grown(const CircleFit& fit, const CirclePrior& prior);

// Enough of the rim in view to be taken for a ball where none was expected; with less than most of
// it also round, and of the ball's size, where that is known. Arms and shadows have arcs, too.
bool stands_out(const CircleFit& fit, const Frame& frame, const std::optional<double>& radius_px);

// Whether a circle that was found is the shadow of the ball that was here just now, whose rim may
// not show for a moment.
bool is_shadow_of(const Frame& frame, const Circle& ball, const CircleFit& found);

}  // namespace impactdic::circle
