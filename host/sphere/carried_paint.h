// The light on a sphere, told by paint that a turn has carried from one place of it to another.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "kernels/types.h"

namespace impactdic::sphere {

// The same paint in two pictures: the normal of the surface there, x right, y down, z towards the
// camera, and the grey level.
struct CarriedPaint {
  std::array<double, 3> first_normal, second_normal;
  double first, second;
};

// One far lamp (Lambert, 1760) and ambient light: what they make of the second level out of the
// first, beside the gains that a registration has free, which follow limb darkening as well.
// `noise`: of a level, grey levels. nullopt where that explains the levels hardly better than those
// gains do by themselves.
std::optional<BallLight> light_on_paint(std::span<const CarriedPaint> paint, double noise);

}  // namespace impactdic::sphere
