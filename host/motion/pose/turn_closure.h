// A ball that has come round shows a keyframe's face again: by how much the chain of registrations
// in between missed it tells the radius.
#pragma once

#include <optional>

#include "host/motion/pose/linked_pose.h"

namespace impactdic::motion {

// The radius as it is thought to be after the same frame was reached by two chains: `along` from
// frame to frame, `closed` from an old keyframe. Bayes' rule with the radius's deviation so far
// and the chains' noise, on the turn about three axes. Empty where the chains say nothing new of
// it, or miss each other by more than the radius explains.
std::optional<SphereRadius> radius_from(const LinkedPose& along, const LinkedPose& closed,
                                        const SphereRadius& radius);

// The pose had the radius been thought to be too large by `error_px` more from the beginning on.
LinkedPose with_radius_error(LinkedPose pose, double error_px);

}  // namespace impactdic::motion
