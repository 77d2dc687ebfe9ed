#include "host/camera/lens.h"

#include <impactdic/units.h>

#include <Eigen/LU>
#include <cmath>

namespace impactdic::camera {

using Eigen::Matrix2d;
using Eigen::Vector2d;

namespace {
constexpr int kMostLensSteps = 40;
constexpr double kConverged = 1e-14;  // of a direction: about 1e-11 px
}  // namespace

Lens::Lens(const Camera& camera)
    : focal_(camera[CameraParameter::kFx], camera[CameraParameter::kFy]),
      principal_(camera[CameraParameter::kCx], camera[CameraParameter::kCy]),
      k1_(camera[CameraParameter::kK1]),
      k2_(camera[CameraParameter::kK2]),
      k3_(camera[CameraParameter::kK3]),
      p1_(camera[CameraParameter::kP1]),
      p2_(camera[CameraParameter::kP2]) {}

Vector2d Lens::project(const Vector2d& direction, Matrix2d* slope) const {
  const double a = direction.x(), b = direction.y(), s = a * a + b * b;
  const double radial = 1 + s * (k1_ + s * (k2_ + s * k3_));
  const Vector2d distorted(a * radial + 2 * p1_ * a * b + p2_ * (s + 2 * a * a),
                           b * radial + p1_ * (s + 2 * b * b) + 2 * p2_ * a * b);
  if (slope != nullptr) {
    const double by_s = k1_ + s * (2 * k2_ + s * 3 * k3_);
    (*slope)(0, 0) = radial + 2 * a * a * by_s + 2 * p1_ * b + 6 * p2_ * a;
    (*slope)(0, 1) = 2 * a * b * by_s + 2 * p1_ * a + 2 * p2_ * b;
    (*slope)(1, 0) = 2 * a * b * by_s + 2 * p1_ * a + 2 * p2_ * b;
    (*slope)(1, 1) = radial + 2 * b * b * by_s + 6 * p1_ * b + 2 * p2_ * a;
    *slope = focal_.asDiagonal() * *slope;
  }
  return focal_.cwiseProduct(distorted) + principal_;
}

Vector2d Lens::direction(const Vector2d& point_px, Matrix2d* slope) const {
  Vector2d found = (point_px - principal_).cwiseQuotient(focal_);
  Matrix2d forward;
  for (int step = 0; step < kMostLensSteps; ++step) {
    const Vector2d off = point_px - project(found, &forward);
    const double det = forward.determinant();
    // Beyond the fold of a polynomial the picture runs backwards: no direction leads there.
    if (!(det > 0) || !off.allFinite()) break;
    const Vector2d change = forward.inverse() * off;
    found += change;
    if (change.squaredNorm() > kConverged * kConverged) continue;
    if (slope != nullptr) *slope = forward.inverse();
    return found;
  }
  if (slope != nullptr) slope->setConstant(kNotMeasured);
  return Vector2d::Constant(kNotMeasured);
}

Vector2d Lens::undistort(const Vector2d& point_px) const {
  return focal_.cwiseProduct(direction(point_px)) + principal_;
}

}  // namespace impactdic::camera
