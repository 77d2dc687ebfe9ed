// What three markers tell of a rod's impact (dissertation, chapter 5): the motion of every frame,
// the velocities on both sides of a blow that is shorter than one frame, and four checks of the
// data itself: free fall, agreement of the marker pairs, closure of the impulses, cone of friction.
//
// Axes: n up, t along the flat towards the upper end of the rod, b out of their plane; angle of the
// rod from the flat, counter-clockwise seen with t to the right.
#pragma once

#include <impactdic/rod.h>

namespace impactdic::sim::rod {

// Throws FormatError where the table shows no blow, the rod stands upright (its plane is then not
// defined), or fewer than four frames of free flight lie on a side.
RodMeasurement measure_rod(const MarkerTable& markers, const RodMeasureOptions& options);

// Closure of the impulses from the velocities alone (Eq. 5.7 integrated over the blow).
RodClosure close_impulses(const RodBody& body, double friction_kinetic, const RodSide& before,
                          const RodSide& after);

}  // namespace impactdic::sim::rod
