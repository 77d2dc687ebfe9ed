// Centres of a sphere by what its turns tell of them.
#pragma once

#include <span>
#include <vector>

#include "host/clip/track_row.h"
#include "host/motion/motion_estimator.h"
#include "host/motion/pose/turned_centres.h"

namespace impactdic::pipeline {

// Rows that motions lead on to from one whose centre is `told` are placed by it, by the motions
// between and by their own circles; `pairs[i]` leads from row i to the next, and is about the row's
// new centre then. A row whose circle contradicts what is told is kInconsistent, and stays where it
// is.
void place_by_turns(std::span<TrackRow> rows, std::span<motion::PairMotion> pairs,
                    std::span<const motion::TurnedCentre> told,
                    const motion::EstimatorOptions& options);

}  // namespace impactdic::pipeline
