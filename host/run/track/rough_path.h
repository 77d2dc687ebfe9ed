// Whether a ball's path is rougher than a flight's or a contact's can be.
#pragma once

#include <string>

#include "host/clip/track_rows.h"

namespace impactdic::run {

// A warning where displacements change from frame to frame by far more than they err by and than
// any force on a ball in flight changes them, and half of the clip does so; "" elsewhere. For clips
// in which neither a flight nor an impact was found. `rows`: one a frame.
std::string rough_path_warning(const TrackRows& rows);

}  // namespace impactdic::run
