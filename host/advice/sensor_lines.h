// Columns and rows of a sensor that differ, as those of a camera do that was not corrected.
#pragma once

#include <optional>
#include <vector>

#include "host/circle/scout_ball.h"
#include "host/clip/frame_range.h"
#include "host/clip/roi.h"
#include "host/video/levels/even_lines.h"

namespace impactdic::advice {

struct SensorLines {
  video::SensorPattern pattern;
  double columns_rms = 0, rows_rms = 0;  // grey levels of 255 at the ball's mean level; 0: none
};

// By the steps from each line to the next on the ball, whose texture moves over the lines: where it
// has passed, its own steps cancel, and those of the lines are left. They count where they are the
// same in both halves of the ball and in every other frame, which the texture's are not; where a
// step is not known the pattern is 0. `ball`: sightings in the region. nullopt where the lines
// do not differ by what can be told, or the ball moves too little.
std::optional<SensorLines> sensor_lines(FrameSource& source, const FrameRange& frames,
                                        const Roi& roi, const circle::BallCandidate& ball);

}  // namespace impactdic::advice
