// A sphere that a disc's model of the rim fits. Internal to host/circle and those who know the
// body.
#pragma once

#include "host/circle/circle.h"

namespace impactdic::circle {

// Of a ball that is known to be a sphere, by its turns or by what was asked for: where the rim was
// measured by a disc's model, which knows neither its light nor that its ink is foreshortened, what
// that may misplace it by joins the deviations. By hand and by other models: nothing.
void doubt_disc(CircleFit& fit);

}  // namespace impactdic::circle
