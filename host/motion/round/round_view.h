// Pictures of a body whose outline is an ellipse, stretched until it is round and freed of light:
// what a sphere's search and registration can work on.
#pragma once

#include <impactdic/image.h>

#include "host/circle/silhouette.h"

namespace impactdic::motion {

// Square pictures of one size, the body's round outline in the middle.
struct RoundFrame {
  double radius_px = 0;  // of the round outline
  int side_px() const;
  double centre_px() const { return 0.5 * (side_px() - 1); }
};

// What of the body is lighter or darker than its surroundings, in local deviations, 0 outside: of
// RoundFrame's size.
using RoundView = Image<float>;

// The picture stretched along its outline's axes; its texture against the mean and the deviation of
// what lies within a seventh of the radius.
RoundView round_view(const Frame& frame, const circle::Silhouette& outline,
                     const RoundFrame& round);

// As grey levels, for a device.
Frame as_frame(const RoundView& view);

}  // namespace impactdic::motion
