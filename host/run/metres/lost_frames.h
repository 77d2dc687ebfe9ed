// What a track says of frames that the file holds twice, or lacks.
#pragma once

#include <string>
#include <vector>

#include "host/clip/track_rows.h"

namespace impactdic::run {

// One for all repeated frames: how many, which is the first, and whether the ball has gone on
// behind them by as much time as they stand for. One for all places where a ball that flies evenly
// goes a whole number of times as far as in the steps beside, in place and turn: frames are missing
// there. Nothing is said of gaps that the file's own times tell (TrackRow::periods).
std::vector<std::string> frame_warnings(const TrackRows& rows);

}  // namespace impactdic::run
