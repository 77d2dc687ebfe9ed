// What a sphere's impact does out of the picture's plane, in SI units.
#pragma once

#include <impactdic/track.h>

namespace impactdic::run {

// In m/s and rad/s where scale and frame rate are known, as it is otherwise.
std::optional<SpaceImpact> to_si(const std::optional<SpaceImpact>& space, const SiScale& scale);

}  // namespace impactdic::run
