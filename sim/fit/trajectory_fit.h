// Weighted least squares of an impact model on the whole measured motion. Internal to sim/fit.
#pragma once

#include "sim/fit/calibration.h"

namespace impactdic::sim::fit {

// Levenberg-Marquardt (Ceres) from start values in closed form of restitution and duration, then
// the covariance of the solution (times the reduced chi square where that exceeds one), and for
// weakly determined parameters the profile likelihood. Throws InvalidArgument where the model has
// no impact at the start values.
ShotFit fit_trajectory(const MeasuredTrack& track, const MeasuredShot& shot, const FitRequest& job);

// The values and the goodness of the fit alone, without deviations and verdicts.
ShotFit fit_values(const MeasuredTrack& track, const MeasuredShot& shot, const FitRequest& job);

}  // namespace impactdic::sim::fit
