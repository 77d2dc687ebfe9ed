// Whether a ball in free flight is seen as an ellipse.
#pragma once

#include <impactdic/track.h>

#include <cstddef>
#include <optional>
#include <string>

#include "host/clip/track_rows.h"

namespace impactdic::run {

// Of all rows of the flights in common.
struct OvalOutline {
  std::size_t frames = 0;   // that show an ellipse
  Measured stretch;         // the long axis over the short one, less 1
  double towards_rad = 0;   // of the long axis, counter-clockwise from image-right, in [0, pi)
  double aside_widths = 0;  // how far from the picture's middle, in its widths
  Measured readout_frames;  // of a rolling shutter, from one row to as many on as the picture has
  double speed_share = 0;   // largest of what that does to a speed
  bool follows_speed = false;  // the ellipse does, as by a rolling shutter
};

// Least squares of the ellipses of the rows by one ellipse and what a rolling shutter makes of a
// circle, which is stretched and sheared in proportion to its velocity (Geyer, Meingast and Sastry
// 2005). nullopt where too few rows show an ellipse, or they scatter by as much as it is: a ball
// that is not round turns it, one that rings makes it come and go.
std::optional<OvalOutline> oval_of_flights(const TrackRows& rows, const ImpactAnalysis& analysis,
                                           int width, int height);

// A warning where the outline is an ellipse beyond chance; "" elsewhere, and where a sphere that is
// seen from as near as three picture widths looks like that, too: longer away from the axis.
std::string oval_warning(const std::optional<OvalOutline>& oval);

}  // namespace impactdic::run
