// Whether the camera moved, and how, by the still background of a clip.
#pragma once

#include <impactdic/clip.h>
#include <impactdic/track.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "host/clip/track_rows.h"

namespace impactdic::shake {

// From some frames spread over the clip and about the sharpest turn of the ball's path; where these
// show that the background moves beyond chance, from all. `rows`: one an analysed frame, in order.
// nullopt where nothing shows it: before a background that stands still, or has no texture.
// `cancelled` (may be empty) ends it early, with nullopt.
std::optional<CameraMotion> measure_camera_motion(FrameSource& source, const TrackRows& rows,
                                                  const std::function<bool()>& cancelled);

struct MotionExtent {
  double farthest_px = 0;      // of the background from where it lies in the reference
  double largest_step_px = 0;  // from row to row
  std::size_t unknown = 0;     // rows where it was not found
};
MotionExtent extent_of(const CameraMotion& motion);

// For people: how far the background moved, one line.
std::string in_words(const CameraMotion& motion);

}  // namespace impactdic::shake
