// What a sphere's registration makes of a centre, a radius and a distance that are not quite right:
// least squares over the visible part of the sphere, of texture alike everywhere, linear in the
// errors, exact in the turn, about parallel rays. Plain numbers: libraries that are built for other
// processors share it.
#pragma once

#include <array>
#include <cstddef>

#include "kernels/types.h"

namespace impactdic::sphere {

// By how much more a motion is measured for each px by which the first picture's centre is told too
// far to the right, too far down, and the radius too large; and for the nearness, the radius over
// the camera's distance, were it told too large by one. Displacements in image axes, px a px and
// px; turns about X right, Y up and Z towards the camera, rad a px and rad.
struct SourceResponse {
  using ToSources = std::array<double, 4>;
  ToSources dx{}, dy{}, rot_x{}, rot_y{}, rot_z{};
};
inline constexpr std::size_t kToRadius = 2, kToNearness = 3;

// A sphere's motion: a rotation vector in those axes, rad, its centre in both pictures from the
// optical axis, image axes, px, and the light on it, in proportion to which its texture stands out;
// all 0: alike everywhere.
struct SphereMove {
  std::array<double, 3> turn{};
  double radius_px = 0;
  std::array<double, 2> aside_px{}, later_aside_px{};
  BallLight light{};
};

// NaN where too little is seen in both pictures.
SourceResponse source_response(const SphereMove& move);

}  // namespace impactdic::sphere
