// How well a fit knows its unknowns. Internal to sim/fit.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/fit/residuals/shot_model.h"

namespace impactdic::sim::fit {

// Covariance for unit noise of every unknown; infinite variance along directions the data leaves
// open.
Eigen::MatrixXd cofactor(const ShotModel& model, const std::vector<double>& values);

// The covariance of all unknowns. The misfit widens what the measurements decide, but not what
// scale and rate, known beforehand, do to the values.
Eigen::MatrixXd widened(const ShotModel& model, const Eigen::MatrixXd& unit, double inflation);

// What an error of the scale or of the rate does to each parameter: its covariance with it, over
// the deviation of that.
void add_parts(ShotFit& fit, const ShotModel& model, const Eigen::MatrixXd& unit);

}  // namespace impactdic::sim::fit
