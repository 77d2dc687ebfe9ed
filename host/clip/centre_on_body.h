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

  // Whether the circle of the next row lies elsewhere on the body than those before: beyond four
  // deviations of both, a hundredth of the radius and half of what makes an ellipse of it, since
  // the outline of a pressed ball need not lie about its centre. If not, and if it is a circle and
  // the row ok, it tells the centre, too. What motions state adds to the variance from row to row.
  bool is_elsewhere(const TrackRow& row);
};

}  // namespace impactdic
