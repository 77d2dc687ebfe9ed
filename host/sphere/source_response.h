// What a sphere's registration makes of a centre and a radius that are not quite right: least
// squares over the visible part of the sphere, of texture alike everywhere, linear in the errors
// and exact in the turn. Plain numbers: libraries that are built for other processors share it.
#pragma once

#include <array>

namespace impactdic::sphere {

// By how much more a motion is measured for each px by which the first picture's centre is told too
// far to the right, too far down, and the radius too large. Displacements in image axes, px a px;
// turns about X right, Y up and Z towards the camera, rad a px.
struct SourceResponse {
  using ToSources = std::array<double, 3>;
  ToSources dx{}, dy{}, rot_x{}, rot_y{}, rot_z{};
};
inline constexpr std::size_t kToRadius = 2;

// `turn`: rotation vector in those axes, rad. NaN where too little is seen in both pictures.
SourceResponse source_response(const std::array<double, 3>& turn, double radius_px);

}  // namespace impactdic::sphere
