// Centres that a frame's own circle hardly tells, from the circles and motions of frames beside it.
#pragma once

#include <span>
#include <vector>

#include "host/clip/track_row.h"
#include "host/motion/motion_estimator.h"

namespace impactdic::pipeline {

// Where the circles of up to twelve frames on either side, each carried here by the motions
// between, tell a row's centre twice as exactly as its own circle does, they place it: what is in
// contact, behind a bar or enters the picture shows little of its rim, but its surface moves as
// exactly as ever. The centre is their mean, by their variances, and states what it would be off
// by if all of them erred alike, or more where they scatter by more. `pairs[i]` leads from row i to
// the next; its motion is about the new centre then, and the row's is yet to be stated. Circles
// that lie `elsewhere` on the body, row by row, place no other. Returns which rows were placed.
std::vector<bool> place_by_path(std::span<TrackRow> rows, std::span<motion::PairMotion> pairs,
                                const std::vector<bool>& elsewhere);

}  // namespace impactdic::pipeline
