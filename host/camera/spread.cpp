#include "host/camera/spread.h"

#include <impactdic/units.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "host/camera/lens.h"
#include "host/camera/plane_view.h"

namespace impactdic::camera {

namespace {
constexpr double kStep = 0.05;      // deviations
constexpr double kNothing = 1e-13;  // of the largest eigenvalue: rounding
}  // namespace

std::vector<CameraStep> principal_steps(const Camera& camera) {
  constexpr int kSize = kCameraParameters;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  const Eigen::Map<const Matrix> given(camera.covariance.data());
  const Vector sd = given.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Vector scale = sd.unaryExpr([](double s) { return s > 0 ? 1 / s : 0.0; });
  const Matrix correlation = scale.asDiagonal() * given * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(correlation);
  std::vector<CameraStep> steps;
  for (int i = kSize - 1; i >= 0; --i) {
    const double variance = solver.eigenvalues()[i];
    if (!(variance > kNothing * solver.eigenvalues()[kSize - 1])) break;
    const Vector step = sd.cwiseProduct(solver.eigenvectors().col(i)) * std::sqrt(variance) * kStep;
    CameraStep one{camera, camera, kStep};
    for (int k = 0; k < kSize; ++k) {
      one.plus.values[static_cast<std::size_t>(k)] += step[k];
      one.minus.values[static_cast<std::size_t>(k)] -= step[k];
    }
    steps.push_back(one);
  }
  return steps;
}

std::vector<double> spread(const Camera& camera,
                           const std::function<std::vector<double>(const Camera&)>& figures) {
  std::vector<double> sd;
  for (const CameraStep& step : principal_steps(camera)) {
    const std::vector<double> plus = figures(step.plus), minus = figures(step.minus);
    sd.resize(plus.size(), 0.0);
    for (std::size_t i = 0; i < plus.size(); ++i) {
      sd[i] = std::hypot(sd[i], (plus[i] - minus[i]) / (2 * step.deviations));
    }
  }
  if (sd.empty()) sd.resize(figures(camera).size(), 0.0);
  return sd;
}

double largest_distortion_px(const Camera& camera) {
  const Lens lens(camera);
  double most = 0;
  for (const double x : {0.0, camera.width - 1.0}) {
    for (const double y : {0.0, camera.height - 1.0}) {
      const Eigen::Vector2d corner(x, y);
      most = std::max(most, (lens.undistort(corner) - corner).norm());
    }
  }
  return most;
}

Measured scale_at_middle(const Camera& camera) {
  const std::vector<double> sd = spread(
      camera, [](const Camera& one) { return std::vector<double>{PlaneView(one).metre_per_px()}; });
  return {PlaneView(camera).metre_per_px(), sd[0]};
}

}  // namespace impactdic::camera

namespace impactdic {

PlaneFigures figures_of(const Camera& camera) {
  PlaneFigures figures{camera.from, camera::scale_at_middle(camera), kNotMeasured,
                       camera::largest_distortion_px(camera)};
  if (camera.focal_length_known) {
    figures.tilt_deg = camera::PlaneView(camera).tilt_rad() * kDegPerRad;
  }
  return figures;
}

}  // namespace impactdic
