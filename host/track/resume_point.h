// What `track_clip` has to know to go on as if it had never been interrupted.
#pragma once

#include <cstdint>
#include <optional>

#include "host/track/ball_tracker.h"
#include "host/track/keyframes.h"

namespace impactdic {

struct ResumePoint {
  // Rows before this one are finished; the first that is given out again. Indices here count the
  // analysed frames.
  std::int64_t next_row = 0;
  CircleFit circle;             // of frame next_row
  BallTracker::Memory tracker;  // behind that frame
  // Of the windows' grid; absent before the first ball.
  std::optional<double> grid_radius_px;
  std::optional<Keyframes::Memory> keyframes;  // with the ball estimator, up to frame next_row
};

}  // namespace impactdic
