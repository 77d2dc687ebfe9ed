// The camera's noise, from a picture alone.
#pragma once

#include <impactdic/image.h>

namespace impactdic::dic {

// Standard deviation of the noise, grey levels of the file: the median magnitude of a second
// difference along both axes (Immerkær 1996) over the flattest part of the picture, so that
// speckles do not count as noise. Clipped pixels, those within half a percent of black or white,
// are left out. Not less than the rounding to whole grey levels, 1/√12.
double estimate_noise(ImageView<const float> picture, double full_scale);

}  // namespace impactdic::dic
