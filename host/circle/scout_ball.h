// The ball in a few frames spread over a clip, before the run.
#pragma once

#include <optional>

#include "host/circle/circle.h"
#include "host/clip/frame_range.h"
#include "host/clip/roi.h"
#include "host/video/frame_source.h"

namespace impactdic::circle {

// The ball's radius, agreed on by the frames in which most of its rim is seen; nullopt where no
// frame shows a ball well enough. A ball that enters the picture shows blobs of speckle before it
// shows its rim: whoever knows the radius is not taken in by them.
//
// Takes 12 frames of the range, more (48 at most) where these do not agree. Reads and searches on
// several threads. A frame that cannot be read shows no ball.
std::optional<double> scout_radius_px(FrameSource& source, const FrameRange& range, const Roi& roi,
                                      const CircleOptions& options);

}  // namespace impactdic::circle
