#include <impactdic/camera/model.h>
#include <impactdic/error.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "host/camera/plane_view.h"

namespace impactdic {
namespace {

constexpr std::array kNames = {"fx_px",
                               "fy_px",
                               "cx_px",
                               "cy_px",
                               "k1",
                               "k2",
                               "p1",
                               "p2",
                               "k3",
                               "rotation_x_rad",
                               "rotation_y_rad",
                               "rotation_z_rad",
                               "position_x_m",
                               "position_y_m",
                               "position_z_m"};
static_assert(kNames.size() == kCameraParameters);
constexpr int kMostPixels = 1 << 16;

using Covariance = Eigen::Matrix<double, kCameraParameters, kCameraParameters, Eigen::RowMajor>;

// Of the correlations, so that units do not matter.
void check_covariance(const Camera& camera) {
  const Eigen::Map<const Covariance> given(camera.covariance.data());
  if (!given.allFinite()) throw InvalidArgument("a number is not finite", "covariance");
  const Eigen::VectorXd variance = given.diagonal();
  if ((variance.array() < 0).any()) throw InvalidArgument("a variance is negative", "covariance");
  const Eigen::VectorXd scale =
      variance.unaryExpr([](double v) { return v > 0 ? 1 / std::sqrt(v) : 0.0; });
  for (Eigen::Index i = 0; i < given.rows(); ++i) {
    if (variance[i] == 0 && given.row(i).cwiseAbs().maxCoeff() > 0) {
      throw InvalidArgument("a value that is exact has a covariance", "covariance");
    }
  }
  const Covariance correlation = scale.asDiagonal() * given * scale.asDiagonal();
  constexpr double kRounding = 1e-7;
  if ((correlation - correlation.transpose()).cwiseAbs().maxCoeff() > kRounding) {
    throw InvalidArgument("it is not symmetric", "covariance");
  }
  const Eigen::SelfAdjointEigenSolver<Covariance> solver(correlation, Eigen::EigenvaluesOnly);
  if (solver.eigenvalues().minCoeff() < -kRounding) {
    throw InvalidArgument("it has a negative variance along some direction", "covariance");
  }
}

// Every picture point must have one direction and meet the plane before the camera.
void check_view(const Camera& camera) {
  const camera::Lens lens(camera);
  const camera::PlaneView view(camera);
  constexpr int kSteps = 8;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d point(i * (camera.width - 1.0) / kSteps,
                                  j * (camera.height - 1.0) / kSteps);
      if (!lens.direction(point).allFinite()) {
        throw InvalidArgument("the distortion folds the picture over", "lens");
      }
      const Eigen::Vector2d seen = view.to_plane(point);
      const Eigen::Vector2d back = view.to_picture({seen.x(), seen.y(), 0});
      const bool before = view.eye().z() > 0 && (back - point).norm() < 1e-3;
      if (!before) throw InvalidArgument("the camera does not look at the plane", "plane");
    }
  }
}

}  // namespace

const char* to_string(CameraParameter parameter) {
  return kNames[static_cast<std::size_t>(parameter)];
}

void Camera::validate() const {
  if (width < 1 || height < 1 || width > kMostPixels || height > kMostPixels) {
    throw InvalidArgument("the pictures have no possible size", "width, height");
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) throw InvalidArgument("this is not finite", kNames[i]);
  }
  for (const auto focal : {CameraParameter::kFx, CameraParameter::kFy}) {
    if (!((*this)[focal] > 0)) throw InvalidArgument("must be positive", to_string(focal));
  }
  if (!((*this)[CameraParameter::kPositionZ] > 0)) {
    throw InvalidArgument("the plane must lie before the camera", "position_z_m");
  }
  check_view(*this);
  check_covariance(*this);
}

}  // namespace impactdic
