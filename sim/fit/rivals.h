// Rival laws fitted to the same shot, and their ranking.
#pragma once

#include "sim/fit/calibration.h"

namespace impactdic::sim::fit {

// Fills fit.rivals: the request's own laws and every other normal law with a spring and a damper
// and every way of damping, by Akaike's criterion for small samples (Hurvich and Tsai 1989). Warns
// where a rival describes the data better, and where laws that fit equally well disagree.
void rank_rivals(ShotFit& fit, const MeasuredTrack& track, const MeasuredShot& shot,
                 const FitRequest& request);

}  // namespace impactdic::sim::fit
