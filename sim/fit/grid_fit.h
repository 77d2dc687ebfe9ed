// Chapter 3's calibration: errors of path and final velocity on a grid of stiffness and damping,
// their sum, and the minimum of the cubic spline through it. Internal to sim/fit.
#pragma once

#include "sim/fit/calibration.h"

namespace impactdic::sim::fit {

// E_d = mean |d_model - d_measured| / max d_measured over the frames of the contact, and
// E_v = |v_model - v_measured| / v_measured of the normal velocity after (section 3.3.1). A node
// whose ball does not leave within ten measured contacts has E_v = 1. Stiffness zero is no spring
// at all: its column is computed at a thousandth of the first step.
ErrorSurface error_surface(const MeasuredTrack& track, const MeasuredShot& shot,
                           const ImpactJob& laws, const FitGrid& grid);

ShotFit fit_grid(const MeasuredTrack& track, const MeasuredShot& shot, const FitRequest& job,
                 ErrorSurface& surface);

}  // namespace impactdic::sim::fit
