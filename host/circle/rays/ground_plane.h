// A plane through levels of the background: light that falls off across the picture. Internal to
// host/circle.
#pragma once

#include <Eigen/Dense>

namespace impactdic::circle {

// level + x_px · x + y_px · y, by least squares.
struct GroundPlane {
  double level = 0, x_px = 0, y_px = 0;  // grey levels, and grey levels a pixel
  double at(double x, double y) const { return level + x_px * x + y_px * y; }
};

class PlaneSums {
 public:
  void add(double x, double y, double level) {
    const Eigen::Vector3d place(1, x, y);
    square_ += place * place.transpose();
    sum_ += level * place;
  }
  GroundPlane plane() const {
    const Eigen::Vector3d found = square_.ldlt().solve(sum_);
    return {found[0], found[1], found[2]};
  }

 private:
  Eigen::Matrix3d square_ = 1e-9 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
};

}  // namespace impactdic::circle
