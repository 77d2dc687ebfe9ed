#include "host/dic/sphere/sphere_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "host/base/statistics.h"
#include "host/dic/sphere/rotation.h"

namespace impactdic::dic {
namespace {

constexpr int kSphereRounds = 20;
constexpr std::size_t kFewest = 8;
constexpr double kPointTukey = 6, kLeastScale_px = 0.03, kSettled_px = 1e-4;
// Points whose surface is seen more from the side tell little.
constexpr double kLeastPointDepth = 0.2;

using PointRow = Eigen::Matrix<double, 5, 1>;

struct OnSphere {
  const PointMotion* point;
  Eigen::Vector3d at;  // camera axes, px
};

std::vector<OnSphere> lift(std::span<const PointMotion> points, const SphereGuess& guess) {
  std::vector<OnSphere> lifted;
  for (const PointMotion& p : points) {
    const double x = p.x_px - guess.cx_px, y = -(p.y_px - guess.cy_px);
    const double square = guess.radius_px * guess.radius_px - x * x - y * y;
    if (square < std::pow(kLeastPointDepth * guess.radius_px, 2)) continue;
    lifted.push_back({&p, {x, y, std::sqrt(square)}});
  }
  return lifted;
}

// Measured less expected displacement, camera axes.
Eigen::Vector2d residual(const OnSphere& p, const SphereFit& fit) {
  const Eigen::Vector3d moved = fit.turn * p.at - p.at;
  return {p.point->u_px - fit.dx_px - moved.x(), -p.point->v_px + fit.dy_px - moved.y()};
}

}  // namespace

bool carry(const SphereGuess& motion, double x_px, double y_px, double& to_x_px, double& to_y_px) {
  const double x = x_px - motion.cx_px, y = -(y_px - motion.cy_px);
  const double square = motion.radius_px * motion.radius_px - x * x - y * y;
  if (!(square > 0)) return false;
  const Eigen::Vector3d to = motion.turn * Eigen::Vector3d(x, y, std::sqrt(square));
  to_x_px = motion.cx_px + motion.dx_px + to.x();
  to_y_px = motion.cy_px + motion.dy_px - to.y();
  return to.z() > kLeastPointDepth * motion.radius_px;
}

SphereFit fit_sphere_motion(std::span<const PointMotion> points, const SphereGuess& guess) {
  SphereFit fit;
  fit.dx_px = guess.dx_px;
  fit.dy_px = guess.dy_px;
  fit.turn = guess.turn;
  const std::vector<OnSphere> lifted = lift(points, guess);
  if (lifted.size() < kFewest) return fit;
  for (int round = 0; round < kSphereRounds; ++round) {
    std::vector<double> sizes;
    for (const OnSphere& p : lifted) sizes.push_back(residual(p, fit).norm());
    // The median length of a normal deviate in the plane is 1.18 deviations.
    const double scale = std::max(upper_median(sizes) / 1.18, kLeastScale_px);
    Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
    PointRow right = PointRow::Zero();
    fit.used = 0;
    for (const OnSphere& p : lifted) {
      const Eigen::Vector2d r = residual(p, fit);
      const double u = r.norm() / (kPointTukey * scale);
      if (u >= 1) continue;
      ++fit.used;
      const double weight = std::pow(1 - u * u, 2) / (scale * scale);
      // Turns after the guess, in the camera's axes.
      const Eigen::Vector3d q = fit.turn * p.at;
      PointRow along_x, along_y;
      along_x << 1, 0, 0, q.z(), -q.y();
      along_y << 0, 1, -q.z(), 0, q.x();
      normal += weight * (along_x * along_x.transpose() + along_y * along_y.transpose());
      right += weight * (along_x * r.x() + along_y * r.y());
    }
    const double by_guess = 1 / (guess.shift_sd_px * guess.shift_sd_px);
    normal(0, 0) += by_guess, normal(1, 1) += by_guess;
    right(0) += by_guess * (guess.dx_px - fit.dx_px);
    right(1) -= by_guess * (guess.dy_px - fit.dy_px);
    const Eigen::LDLT<Eigen::Matrix<double, 5, 5>> solver(normal);
    if (solver.info() != Eigen::Success) return fit;
    const PointRow step = solver.solve(right);
    if (!step.allFinite()) return fit;
    fit.dx_px += step(0);
    fit.dy_px -= step(1);
    fit.turn = (quaternion_of(step.tail<3>()) * fit.turn).normalized();
    fit.residual_px = scale;
    const Eigen::Matrix<double, 5, 5> covariance =
        solver.solve(Eigen::Matrix<double, 5, 5>::Identity());
    fit.rot_x_sd_rad = std::sqrt(covariance(2, 2));
    fit.rot_y_sd_rad = std::sqrt(covariance(3, 3));
    const double moved = step.head<2>().norm() + guess.radius_px * step.tail<3>().norm();
    if (moved < kSettled_px) break;
  }
  fit.share = static_cast<double>(fit.used) / static_cast<double>(lifted.size());
  fit.ok = static_cast<std::size_t>(fit.used) >= kFewest;
  return fit;
}

}  // namespace impactdic::dic
