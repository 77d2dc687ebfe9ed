// The light on a sphere most of which is one paint, told by a single picture.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "kernels/types.h"

namespace impactdic::sphere {

// A place of a sphere's picture: the normal of its surface, x right, y down, z towards the camera,
// and the grey level.
struct SeenPaint {
  std::array<double, 3> normal;
  double level;
};

// One far lamp (Lambert, 1760) and ambient light that make the levels of most places, seams and
// marks apart. `noise`: of a level, grey levels. nullopt where no such light does, or where it is
// even.
std::optional<BallLight> light_on_bare_paint(std::span<const SeenPaint> paint, double noise);

}  // namespace impactdic::sphere
