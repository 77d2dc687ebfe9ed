// From where a clip's sphere is seen.
#pragma once

#include <impactdic/camera/model.h>
#include <impactdic/track.h>

#include <functional>
#include <optional>
#include <string>

#include "host/motion/perspective.h"

namespace impactdic::run {

// Of the clip's whole frames. A calibrated camera knows it, else the distance that was given, with
// the ball's diameter or a scale, and the optical axis in the middle of the picture. Parallel rays
// where neither is known. `radius_px`: of the ball.
motion::Perspective perspective_of(const TrackRequest& request, const std::optional<Camera>& camera,
                                   const ClipInfo& clip, double radius_px);

// The same in the frames' parts that are looked at.
motion::Perspective in_region(motion::Perspective perspective, const Roi& roi);

inline constexpr char kParallelRays[] =
    "parallel rays are assumed, since no --distance-mm or --camera is given: from N ball radii "
    "away "
    "a turn out of the picture's plane reads about 100/N % too large, which is not part of the "
    "deviations";
std::string sphere_in_words(const Measured& radius_px, const motion::Perspective& perspective);

// Puts a row's circle about the ball's centre, as motions of a sphere that was registered in
// perspective are of it. Empty of parallel rays: there it is already.
std::function<void(TrackRow&)> about_centres(const motion::Perspective& perspective);

}  // namespace impactdic::run
