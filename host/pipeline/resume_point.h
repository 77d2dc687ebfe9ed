// What `track_clip` and `correlate_clip` have to know to go on as if they had never been
// interrupted.
#pragma once

#include <cstdint>
#include <optional>

#include "host/circle/ball_tracker.h"
#include "host/clip/centre_on_body.h"
#include "host/motion/pose/keyframes.h"

namespace impactdic::pipeline {

struct ResumePoint {
  // Rows before this one are finished; the first that is given out again. Indices here count the
  // analysed frames.
  std::int64_t next_row = 0;
  bool repeated = false;                // whether frame next_row shows the picture before it
  circle::CircleFit circle;             // of frame next_row
  circle::BallTracker::Memory tracker;  // behind that frame
  // Of the windows' grid; absent before the first ball.
  std::optional<double> grid_radius_px;
  std::optional<motion::Keyframes::Memory>
      keyframes;        // with the ball estimator, up to frame next_row
  CentreOnBody centre;  // before that frame
};

struct CorrelatePoint {
  std::int64_t next_row = 0;  // the first frame that is not measured yet
  // Where the region is looked for: the last motion that was measured.
  double dx_px = 0, dy_px = 0, rot_rad = 0;
  int vain_searches = 0;  // since
};

}  // namespace impactdic::pipeline
