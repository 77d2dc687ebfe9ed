// Circles against where keyframes place the ball, over a whole flight and contact.
#pragma once

#include <impactdic/track.h>

#include <cstdint>

namespace impactdic {

// Where circles have had the ball's centre: beside the place that keyframes gave, turned back with
// the body, px, x right and y down. Of the body as it was found first: one that was lost may have
// been found elsewhere.
struct CentreOnBody {
  std::int64_t origin = -1;  // of the poses, see BodyPose
  int circles = 0;           // that have told it
  double x_px = 0, y_px = 0, variance_px2 = 0;
  // What the motions since then state, px: all of them may err alike, as a pattern on the sensor
  // makes them.
  double untold_px = 0;

  // How far beside that place the circle of the next row lies, px, x right and y down: 0 within
  // four deviations of both, and where somebody has looked at it. `elsewhere`: also beyond a
  // hundredth of the radius and half of what makes an ellipse of it, since the outline of a pressed
  // ball need not lie about its centre.
  struct Beside {
    double x_px = 0, y_px = 0;
    bool elsewhere = false;
  };
  // If it is not elsewhere, and if it is a circle and the row ok, it tells the centre, too.
  Beside compare(const TrackRow& row);
};

}  // namespace impactdic
