// The motions of several pairs of frames, aimed by themselves.
#pragma once

#include <span>

#include "host/motion/motion_estimator.h"

namespace impactdic::motion {

// Measures `pairs`, whose frames are in their slots, from a guess of the rotation that the pairs
// themselves give: the aiming pass over the first and the last pair shows how the ball turns, all
// start from there, and a pair that turned out to turn otherwise than its windows were aimed is
// measured again. Nothing but the pairs says what comes out, so a clip may be cut into batches
// anywhere.
void measure_pairs(MotionEstimator& estimator, double radius_px, std::span<PairMotion> pairs);

}  // namespace impactdic::motion
