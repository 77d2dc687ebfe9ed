// A whole synthetic clip, frames in order.
#pragma once

#include <impactdic/control.h>

#include <functional>
#include <span>

#include "sim/speckle/render.h"

namespace impactdic::sim::speckle {

// Renders frame k at poses[k], the shutter open for `exposure` (0 … 1) of the frame interval around
// it. Frames are rendered by all threads and handed to `consume` one after the other in order.
// What `consume` throws ends the clip and is thrown on. Returns how many frames were handed over:
// fewer than there are poses where the caller has cancelled.
std::size_t render_clip(const FrameRenderer& renderer, std::span<const BallPose> poses,
                        double exposure, const std::function<void(const Frame&)>& consume,
                        const RunControl& control = {});

}  // namespace impactdic::sim::speckle
