// What `track_clip` has to know to go on as if it had never been interrupted.
#pragma once

#include <cstdint>
#include <optional>

#include "host/circle/ball_tracker.h"
#include "host/motion/keyframes.h"

namespace impactdic::pipeline {

struct ResumePoint {
  // Rows before this one are finished; the first that is given out again. Indices here count the
  // analysed frames.
  std::int64_t next_row = 0;
  circle::CircleFit circle;             // of frame next_row
  circle::BallTracker::Memory tracker;  // behind that frame
  // Of the windows' grid; absent before the first ball.
  std::optional<double> grid_radius_px;
  std::optional<motion::Keyframes::Memory>
      keyframes;  // with the ball estimator, up to frame next_row
};

}  // namespace impactdic::pipeline
