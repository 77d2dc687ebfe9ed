// What rows that follow each other say of each other: circles measured frame by frame, and motions
// measured between them.
#pragma once

#include <span>
#include <vector>

#include "host/clip/centre_on_body.h"
#include "host/clip/track_row.h"

namespace impactdic::pipeline {

// A motion that is not the one of the circles' centres, by more than 0.1 px and six deviations of
// what both state, is kInconsistent.
void compare_with_circles(TrackRow& row, const TrackRow& next);
// After that: circles that scatter about the path on which the motions lead by more than they state
// state as much as they scatter, and one that lies off it alone states by how much. The same for
// radii of frames that show a circle. Returns which rows' centres state more now. What circles have
// alike (a light that all of them take for a part of the ball) does not show here.
std::vector<bool> state_scatter(std::span<TrackRow> rows);
// At last: a circle that lies beside where those before have it on the body states by how much, and
// its row is kInconsistent where it lies elsewhere. `centre` goes along from call to call: `rows`
// follow those of the last one. Sets `changed` where centres state more now.
void compare_with_poses(std::span<TrackRow> rows, CentreOnBody& centre, std::vector<bool>& changed);

}  // namespace impactdic::pipeline
