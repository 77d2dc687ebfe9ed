// What a track says of frames that the file holds twice, or lacks.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/clip/track_rows.h"

namespace impactdic::run {

// One for all repeated frames: how many, which is the first, and whether the ball has gone on
// behind them by as much time as they stand for; "" where there are none.
std::string repeats_warning(const TrackRows& rows);

struct MissingFrames {
  std::size_t behind = 0;  // row
  int count = 0;
};

// Where a ball that flies evenly goes a whole number of times as far as in the steps beside, in
// place and turn. Gaps that the file's own times tell (TrackRow::periods) are not among them.
std::vector<MissingFrames> missing_frames(const TrackRows& rows);

// Has row `i` count them: its periods, and its time, by the rate of the analysed frames.
void count(const std::vector<MissingFrames>& missing, double fps, std::size_t i, TrackRow& row);

// One for all that are missing, of which there are some.
std::string missing_warning(const std::vector<MissingFrames>& missing, const TrackRows& rows);

}  // namespace impactdic::run
