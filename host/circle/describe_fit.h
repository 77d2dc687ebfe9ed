// From a fit to the circle that is stated: what ink, light, exposure and a background's texture may
// misplace it by joins the deviations. Internal to host/circle.
#pragma once

#include "host/circle/circle.h"
#include "host/circle/model_fit.h"
#include "host/circle/rim/rim.h"
#include "host/circle/settings/judgement.h"

namespace impactdic::circle {

// Points and arc enough for a circle.
template <typename Fit>
bool is_enough(const Fit& fit) {
  return fit.ok && fit.points >= kJudge.least_points && fit.arc >= kJudge.least_arc;
}

// Whether the brightest that lies beside the rim is at the end of the camera's scale. How bright it
// would be is not known, nor then where half of that is.
bool is_over_exposed(double brightest, const Frame& frame);

// Rim, radius and their deviations as the fit has them; `radius_bias_sd_px` as in CirclePrior.
void fill(const RimFit& fit, double edge_sigma_px, double radius_bias_sd_px, CircleFit& result);

// See Circle::free_px.
double free_distance(const RimTrace& trace, const Rim& rim);

// Of a rim model's fit.
CircleFit describe(const Frame& frame, const ModelFit& m, const LineTrace& trace,
                   const CirclePrior& prior, bool bright);
// The same where the lines themselves are elsewhere; `gap_rad`: the widest between two of them.
CircleFit describe(const Frame& frame, const ModelFit& m, const LineTrace& trace, double gap_rad,
                   const CirclePrior& prior, bool bright);

// The fit with the status that its circle deserves.
CircleFit accepted(CircleFit fit, const Frame& frame, const CircleOptions& options);

}  // namespace impactdic::circle
