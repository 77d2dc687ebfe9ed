// The surface as the picture shows it: the straight edge that the ball touches.
#pragma once

#include <impactdic/track.h>

#include <optional>

#include "host/clip/track_rows.h"

namespace impactdic::run {

// Where a ball touches the surface: its circle in the picture, y down, and the direction from its
// centre to the surface, about; counter-clockwise from image-right, rad.
struct Touch {
  double x_px = 0, y_px = 0, radius_px = 0;
  double towards_rad = 0;
};

// An angle between -180 and 180 degrees.
double turned_into(double angle_deg);

// What stands still about the touch: the mean of some frames, each without its ball. `seen` is 0
// where no frame shows what is behind it, and far from the touch.
struct StillPicture {
  Image<float> grey;  // of 0 … 255
  Image<std::uint8_t> seen;
};
// Throws what reading throws.
StillPicture still_picture(FrameSource& source, const TrackRows& rows, const Touch& touch);

// Of the straight edges that touch the circle, within 50 degrees of the direction, the one of most
// contrast: its inclination as --surface-angle-deg counts it. nullopt where none stands out over a
// length of one and a half radii.
std::optional<Measured> edge_angle_deg(const StillPicture& still, const Touch& touch);

// The same of an impact. nullopt also where the frames cannot be read again.
std::optional<Measured> surface_in_picture(FrameSource& source, const TrackRows& rows,
                                           const ImpactAnalysis& analysis);

// Adds the contradiction between the edge and the angle that was given, unless path and spin show
// the given one.
void compare_with_edge(const TrackRequest& request, const Measured& edge_deg,
                       ImpactFigures& figures);

}  // namespace impactdic::run
