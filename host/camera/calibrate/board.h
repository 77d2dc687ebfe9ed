// What a calibration works with: the target's own points, and where pictures show them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace impactdic::camera {

struct Sighting {
  std::size_t point = 0;        // of the target
  Eigen::Vector2d at_px{0, 0};  // in the picture
  // Of its place by the noise of the picture, px²; 0: not known.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

struct View {
  std::string picture;
  std::vector<Sighting> seen;
};

// Points of the flat target in its own plane, m.
using BoardPoints = std::vector<Eigen::Vector2d>;

}  // namespace impactdic::camera
