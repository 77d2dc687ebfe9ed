// A ball that has come round shows a keyframe's face again: by how much the chain of registrations
// in between missed it tells the radius and the distance.
#pragma once

#include <optional>

#include "host/motion/pose/linked_pose.h"

namespace impactdic::motion {

// Radius and distance as they are thought to be after the same frame was reached by two chains:
// `along` from frame to frame, `closed` from an old keyframe. Bayes' rule with both deviations so
// far and the chains' noise, on the turn about three axes (Kalman 1960). Both do nearly the same to
// a chain: what is learnt is what they do together. Empty where the chains say nothing new of it,
// or miss each other by more than both explain.
std::optional<SphereRadius> radius_from(const LinkedPose& along, const LinkedPose& closed,
                                        const SphereRadius& radius);

// The pose had the errors of radius and distance been thought to be those of `now` from the
// beginning on, instead of those of `before`.
LinkedPose with_errors(LinkedPose pose, const SphereRadius& before, const SphereRadius& now);

}  // namespace impactdic::motion
