// How far the deviations that a track states can be trusted: errors that last over many frames.
#pragma once

#include <span>

#include "sim/fit/residuals/shot_model.h"

namespace impactdic::sim::fit {

// The square root of the long-run variance of residuals over their stated deviations: 1 for white
// noise as stated, more where it is larger or where errors last (a sub-pixel bias, the rim of a
// compressed ball), because frames that err alike do not average out. Newey and West (1987), with
// the Bartlett window; centres, motions and rotations each for themselves.
DeviationFactors deviation_factors(const ShotModel& model,
                                   std::span<const double> stated_residuals);

}  // namespace impactdic::sim::fit
