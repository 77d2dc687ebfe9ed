// How much of a ball's rim a fit has seen of what lies in the picture.
#pragma once

#include <optional>

#include "host/circle/circle.h"

namespace impactdic::circle {

// Share of the rim in view that carried the fit.
double rim_in_view(const CircleFit& fit, const Frame& frame);

bool is_round(const CircleFit& fit);

// Enough of the rim in view to be taken for a ball where none was expected; with less than most of
// it also round, and of the ball's size, where that is known. Arms and shadows have arcs, too.
bool stands_out(const CircleFit& fit, const Frame& frame, const std::optional<double>& radius_px);

}  // namespace impactdic::circle
