// Deviations of a circle whose rim is not as its model has it. Internal to host/circle and those
// who know the body.
#pragma once

#include "host/circle/circle.h"

namespace impactdic::circle {

// Adds to the deviations what light or ink that are not as they are taken to be may misplace the
// radius and the centre by; the centre of an arc goes with its radius (CircleFit::cx_with_r).
void widen(CircleFit& fit, double centre_px, double radius_px);

// Whether what was measured is an arc, whose centre goes along with its radius.
bool is_cut(const CircleFit& fit);

// Of a ball that is known to be a sphere, by its turns or by what was asked for: where the rim was
// measured by a disc's model or by crossings, which know neither its light nor that its ink is
// foreshortened and may show its lit side alone, what that may misplace it by joins the deviations.
// By hand and by other models: nothing.
void doubt_disc(CircleFit& fit);

}  // namespace impactdic::circle
