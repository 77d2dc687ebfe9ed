// The sixteen painted balls as spheres: the ink lies on the surface, on the far side too.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/speckle/pattern.h"

namespace impactdic::sim::speckle {

// Ball axes: those of the camera (X right, Y up, Z towards it) where the ball is not turned.
// A circle on the surface. Facing the camera, its picture is a disc of radius_px.
struct InkCap {
  Eigen::Vector3d centre;  // unit vector
  double radius_px;        // below the ball's
};
// A straight line on the surface: a strip along a great circle.
struct InkStrip {
  Eigen::Vector3d middle, along;  // unit vectors, at right angles
  double length_px, width_px;     // on the surface; shorter than half a great circle
};

struct SpeckleSphere {
  double radius_px = 115;
  std::vector<InkCap> caps;
  std::vector<InkStrip> strips;
};

// Paints a sphere evenly, with the same sizes of speckles and the same share of ink as the disc of
// that name has. The same name, seed and radius give the same sphere. Density is that of the
// picture at half level where the surface faces the camera; over the whole sphere within 0.5 points
// for radius 115 px. Strips lie evenly too: as long a line on each area as the disc has on average.
// Throws InvalidArgument for an unknown name or a radius not in 20 ... 2000 px.
SpeckleSphere paint_sphere(const std::string& pattern, std::uint64_t seed, double radius_px = 115);

// Share of ink and areas of speckles at half level, over twelve round patches that cover nine
// tenths of the sphere, each laid flat without change of area.
InkMeasure measure_ink(const SpeckleSphere& sphere);

}  // namespace impactdic::sim::speckle
