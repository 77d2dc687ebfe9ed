// The light on a sphere by what the ball shows in the mean, where ink leaves too little bare paint.
// Internal to host/circle.
#pragma once

#include <optional>

#include "host/circle/sphere/sphere_light.h"

namespace impactdic::circle {

// Whether ink leaves too little bare paint in the samples to be sure of a light that was fitted to
// nothing else.
bool hides_paint(const SphereSamples& samples, const SphereLight& light);
// The light by what the ball shows in the mean where that contradicts `light`.
SphereLight checked_by_means(const SphereSamples& samples, double ground, const SphereLight& light);
// A light that was told so, as bright as it is in these samples. nullopt where too little of the
// ball is seen.
std::optional<SphereLight> as_bright(const SphereSamples& samples, double ground,
                                     const SphereLight& light);

}  // namespace impactdic::circle
