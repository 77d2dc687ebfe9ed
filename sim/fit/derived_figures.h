// What the fitted impact does, with the deviation that the fit carries over. Internal to sim/fit.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/fit/calibration.h"
#include "sim/fit/residuals/shot_model.h"

namespace impactdic::sim::fit {

// Restitution, duration, time of the largest compression and largest deflection of the impact with
// these values; `covariance` is of all unknowns of the model. A figure that an undetermined unknown
// moves has no deviation (NaN).
std::vector<DerivedFigure> derived_figures(const ShotModel& model,
                                           const std::vector<double>& values,
                                           const Eigen::MatrixXd& covariance);

}  // namespace impactdic::sim::fit
