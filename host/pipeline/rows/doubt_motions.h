// Motions that lead elsewhere than the circles do, by less than a contradiction.
#pragma once

#include <span>
#include <vector>

#include "host/clip/track_row.h"
#include "host/motion/motion_estimator.h"

namespace impactdic::pipeline {

// What stands still on the sensor or before the ball (columns that differ, a veil, dirt on a
// window) slows every motion alike, by less than one of them shows. Over up to twelve frames on
// either side it adds up: where the circles leave the motions' path by a slope beyond six
// deviations, and by less than a tenth of the motion, the flat ball's motion there states that
// slope, px a frame. One alone that is not the way between its two circles, beyond six deviations,
// as where light flares up, states by how much. `pairs[i]` leads from row
// i to the next. Returns which of them state more now: what their rows state is yet to follow.
std::vector<bool> doubt_motions(std::span<const TrackRow> rows,
                                std::span<motion::PairMotion> pairs);

}  // namespace impactdic::pipeline
