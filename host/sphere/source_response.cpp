#include "host/sphere/source_response.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace impactdic::sphere {
namespace {

// X, Y, turns about X, Y, Z; to X, Y, radius, nearness. Lengths in radii.
using Response = Eigen::Matrix<double, 5, 4>;
constexpr int kAcross = 13;                            // points over the disc
constexpr double kLeastDepth = 0.2, kFullDepth = 0.5;  // of the radius, as the kernel weighs pixels

// Points of the unit sphere's visible half, evenly over its disc, camera axes.
const std::vector<Eigen::Vector3d>& points() {
  static const std::vector<Eigen::Vector3d> all = [] {
    std::vector<Eigen::Vector3d> made;
    for (int j = 0; j < kAcross; ++j) {
      for (int i = 0; i < kAcross; ++i) {
        const double x = 2 * (i + 0.5) / kAcross - 1, y = 2 * (j + 0.5) / kAcross - 1;
        if (x * x + y * y < 1) made.emplace_back(x, y, std::sqrt(1 - x * x - y * y));
      }
    }
    return made;
  }();
  return all;
}

// The square of the light at a point, which goes with what its texture tells.
double worth(const BallLight& light, const Eigen::Vector3d& at) {
  if (!(light.least > 0)) return 1;
  const double facing = light.lamp[0] * at.x() - light.lamp[1] * at.y() + light.lamp[2] * at.z();
  const double level = light.ambient + std::max(facing, 0.0);
  return level * level;
}

// With B the motions' Jacobian of where a pixel of the first picture goes, pulled back into it by
// L⁻¹ (L: how the second picture's pixels follow the first one's), B = L⁻¹ (1, q × at): the sums of
// BᵀB and BᵀE, where E are the errors' own shifts.
// A nearer camera sees the point `at` of the first picture's pixel along a line that leans by that
// pixel's distance from the optical axis, and shows the turned point as much farther off it.
// `aside`: the centre's in the first picture, `later` in the second one.
Response response_of(const Eigen::Matrix3d& q, const Eigen::Vector2d& aside,
                     const Eigen::Vector2d& later, const BallLight& light) {
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Response right = Response::Zero();
  const Eigen::Matrix<double, 2, 3> top = q.topRows<2>();
  for (const Eigen::Vector3d& at : points()) {
    const double depth = std::min(at.z(), q.row(2).dot(at));
    const double weight =
        worth(light, at) * std::clamp((depth - kLeastDepth) / (kFullDepth - kLeastDepth), 0.0, 1.0);
    if (weight == 0) continue;
    // Along the sphere where the first picture's pixel moves.
    Eigen::Matrix2d local;
    local.col(0) = top.col(0) - at.x() / at.z() * top.col(2);
    local.col(1) = top.col(1) - at.y() / at.z() * top.col(2);
    const Eigen::Matrix2d back = local.inverse();
    Eigen::Matrix<double, 2, 3> turns;  // of a unit turn about each axis
    turns.col(0) = at.y() * top.col(2) - at.z() * top.col(1);
    turns.col(1) = at.z() * top.col(0) - at.x() * top.col(2);
    turns.col(2) = at.x() * top.col(1) - at.y() * top.col(0);
    const Eigen::Matrix2d square = weight * back.transpose() * back;
    Eigen::Matrix<double, 2, 4> by_error;
    by_error.leftCols<2>() = square - weight * back.transpose();
    by_error.col(2) = square * top.col(2) / at.z();
    Eigen::Vector3d slide;
    slide << -at.z() * (at.head<2>() + aside), at.head<2>().dot(at.head<2>() + aside);
    const Eigen::Vector3d turned = q * at;
    by_error.col(3) = square * (top * slide + turned.z() * (turned.head<2>() + later));
    const Eigen::Matrix<double, 2, 3> square_turns = square * turns;
    normal.topLeftCorner<2, 2>() += square;
    normal.topRightCorner<2, 3>() += square_turns;
    normal.bottomRightCorner<3, 3>() += turns.transpose() * square_turns;
    right.topRows<2>() -= by_error;
    right.bottomRows<3>() -= turns.transpose() * by_error;
  }
  normal.bottomLeftCorner<3, 2>() = normal.topRightCorner<2, 3>().transpose();
  return normal.ldlt().solve(right);
}

}  // namespace

SourceResponse source_response(const SphereMove& move) {
  const Eigen::Vector3d vector(move.turn[0], move.turn[1], move.turn[2]);
  const double angle = vector.norm();
  Eigen::Matrix3d q = Eigen::Matrix3d::Identity();
  if (angle > 0) q = Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
  const auto in_radii = [&](const std::array<double, 2>& aside_px) -> Eigen::Vector2d {
    return Eigen::Vector2d(aside_px[0], -aside_px[1]) / move.radius_px;
  };
  const Response up =
      response_of(q, in_radii(move.aside_px), in_radii(move.later_aside_px), move.light);
  SourceResponse response;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const double shifts = (k == 1 ? -1 : 1) * (k == kToNearness ? move.radius_px : 1);
    const double turns = shifts / move.radius_px;
    response.dx[k] = shifts * up(0, column);
    response.dy[k] = -shifts * up(1, column);
    response.rot_x[k] = turns * up(2, column);
    response.rot_y[k] = turns * up(3, column);
    response.rot_z[k] = turns * up(4, column);
  }
  return response;
}

}  // namespace impactdic::sphere
