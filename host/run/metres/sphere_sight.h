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
// where neither is known, which is_unknown() then says. `radius_px`: of the ball.
motion::Perspective perspective_of(const TrackRequest& request, const std::optional<Camera>& camera,
                                   const ClipInfo& clip, double radius_px);

// As above, where pictures told the radius over the distance; unchanged where they did not.
motion::Perspective as_pictures_show(motion::Perspective seen, const Measured& nearness,
                                     double radius_px);
// Of a sphere's outline where its radius is this: R / sqrt(1 - (R/D)^2), which is farther out the
// nearer the camera stands.
Measured outline_radius(const Measured& radius_px, const motion::Perspective& seen);
// Sets what `result`, which has the sphere's radius, says of this over the distance, and what told
// it; `shown`: by the pictures.
void state_nearness(const std::optional<Camera>& camera, const motion::Perspective& perspective,
                    const Measured& shown, TrackResult& result);

// As seen in the frames' parts that are looked at.
motion::Perspective in_region(motion::Perspective perspective, const Roi& roi);

inline constexpr char kDistanceUnknown[] =
    "the camera's distance is not known: no --distance-mm or --camera is given, and the ball turns "
    "too little for its pictures to tell; the deviations of turns out of the picture's plane are "
    "large for it";
std::string sphere_in_words(const Measured& radius_px, const motion::Perspective& perspective);

// Puts a row's circle about the ball's centre, as motions of a sphere that was registered in
// perspective are of it. Empty of parallel rays: there it is already.
std::function<void(TrackRow&)> about_centres(const motion::Perspective& perspective);

}  // namespace impactdic::run
