// In plain words: why a parameter is not determined, and what would determine it. Internal.
#pragma once

#include "sim/fit/calibration.h"

namespace impactdic::sim::fit {

// Fills the verdict of every parameter of `fit`, from the simulated impact of the solution.
void add_verdicts(ShotFit& fit, const ImpactJob& solution);

}  // namespace impactdic::sim::fit
