// Motions against circles over some frames that follow each other.
#pragma once

#include <span>

#include "host/clip/track_row.h"

namespace impactdic::pipeline {

// After compare_with_circles: small errors that every motion has alike add up over some frames,
// those of the circles do not. Rows among which the motions lead elsewhere than the circles, beyond
// six deviations and by 0.02 px a frame, are kInconsistent; but not those that circles on both
// sides bear out, where a wrong circle among them is to blame.
void compare_with_path(std::span<TrackRow> rows);

}  // namespace impactdic::pipeline
