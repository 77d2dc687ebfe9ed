// Metres through a calibrated camera: corrected rows, and what the camera's covariance does to
// every figure.
#pragma once

#include <impactdic/camera/model.h>
#include <impactdic/track.h>

#include <optional>
#include <vector>

#include "host/motion/perspective.h"

namespace impactdic::run {

// Sets camera, corrected rows, scale and impact of `result` from `rows`, which a camera that stands
// still has seen. The camera's part of
// every deviation is found by differences of the whole way from rows to figures, along the
// principal axes of its covariance. `perspective`: in which a sphere was registered.
void conclude_through_camera(const Camera& camera, const TrackRequest& request,
                             const std::vector<TrackRow>& rows,
                             const std::optional<Measured>& sphere_radius_px, TrackResult& result,
                             const motion::Perspective& perspective = {});

// Throws InvalidArgument where the camera was calibrated with pictures of another size.
void check_camera_fits(const Camera& camera, const ClipInfo& clip, const std::string& file);

}  // namespace impactdic::run
