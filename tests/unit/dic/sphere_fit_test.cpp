// A sphere's motion from points on it, and what errors of its centre and radius do to it.
#include "host/dic/sphere/sphere_fit.h"

#include <gtest/gtest.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "host/dic/sphere/rotation.h"
#include "host/dic/sphere/sphere_errors.h"

namespace impactdic::dic {
namespace {

constexpr double kCx = 130, kCy = 121, kRadius = 100;

SphereGuess motion(const Eigen::Vector3d& turn_deg, double dx, double dy) {
  SphereGuess truth;
  truth.cx_px = kCx;
  truth.cy_px = kCy;
  truth.radius_px = kRadius;
  truth.dx_px = dx;
  truth.dy_px = dy;
  truth.turn = quaternion_of(turn_deg * kRadPerDeg);
  return truth;
}

// Where the sphere's motion takes a grid of points.
std::vector<PointMotion> points_of(const SphereGuess& truth) {
  std::vector<PointMotion> points;
  for (double y = kCy - kRadius; y <= kCy + kRadius; y += 5) {
    for (double x = kCx - kRadius; x <= kCx + kRadius; x += 5) {
      double to_x, to_y;
      if (carry(truth, x, y, to_x, to_y)) points.push_back({x, y, to_x - x, to_y - y, 0.01});
    }
  }
  return points;
}

TEST(SphereFit, FindsTheMotionFromWrongGuessesAndOutliers) {
  const SphereGuess truth = motion({2, -3, 4}, 0.8, -0.5);
  std::vector<PointMotion> points = points_of(truth);
  std::mt19937 random(3);
  for (std::size_t i = 0; i < points.size(); i += 5) {
    points[i].u_px += 3 + 1e-9 * static_cast<double>(random());
  }
  SphereGuess guess = motion({0, 0, 0}, 0.9, -0.6);
  const SphereFit fit = fit_sphere_motion(points, guess);
  ASSERT_TRUE(fit.ok);
  EXPECT_NEAR(fit.dx_px, 0.8, 0.003);
  EXPECT_NEAR(fit.dy_px, -0.5, 0.003);
  EXPECT_LT(fit.turn.angularDistance(truth.turn) * kDegPerRad, 0.003);
  EXPECT_NEAR(fit.share, 0.8, 0.05);
}

TEST(SphereFit, FewPointsAreNoMotion) {
  const std::vector<PointMotion> points(5, {kCx, kCy, 1, 1, 0.01});
  EXPECT_FALSE(fit_sphere_motion(points, motion({0, 0, 0}, 1, 1)).ok);
}

// The motion by two translations and a turn after the truth's, X and Y up.
using Parameters = Eigen::Matrix<double, 5, 1>;

// Where a sphere of this source and motion takes a pixel, camera axes about the true centre.
Eigen::Vector2d taken(const Eigen::Vector2d& p, const Eigen::Vector3d& source,
                      const Eigen::Quaterniond& turn, const Parameters& by) {
  const Eigen::Vector2d from = p - source.head<2>();
  const double radius = kRadius + source.z();
  const Eigen::Vector3d at(from.x(), from.y(), std::sqrt(radius * radius - from.squaredNorm()));
  const Eigen::Vector3d to = turn * quaternion_of(by.tail<3>()) * at;
  return source.head<2>() + by.head<2>() + to.head<2>();
}

// What least squares over the pixels of the first picture find off the truth where the source is
// off, by differences alone.
Parameters found_off(const Eigen::Quaterniond& turn, const Eigen::Vector3d& source) {
  constexpr double kStep = 1e-5;
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Parameters right = Parameters::Zero();
  for (double y = -kRadius; y <= kRadius; y += 2) {
    for (double x = -kRadius; x <= kRadius; x += 2) {
      const Eigen::Vector2d p(x, y);
      if (p.norm() >= kRadius) continue;
      const Eigen::Vector3d at(x, y, std::sqrt(kRadius * kRadius - p.squaredNorm()));
      const double depth = std::min(at.z(), (turn * at).z()) / kRadius;
      const double weight = std::clamp((depth - 0.2) / 0.3, 0.0, 1.0);
      if (weight == 0) continue;
      const Eigen::Vector3d none = Eigen::Vector3d::Zero();
      const auto shift = [&](const Eigen::Vector2d& from, const Parameters& by) {
        return taken(from, none, turn, by);
      };
      Eigen::Matrix2d local;
      for (int axis : {0, 1}) {
        const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
        local.col(axis) =
            (shift(p + step, Parameters::Zero()) - shift(p - step, Parameters::Zero())) /
            (2 * kStep);
      }
      const Eigen::Matrix2d back = local.inverse();
      Eigen::Matrix<double, 2, 5> slopes;
      for (int k = 0; k < 5; ++k) {
        const Parameters step = kStep * Parameters::Unit(k);
        slopes.col(k) = back * (shift(p, step) - shift(p, -step)) / (2 * kStep);
      }
      const Eigen::Vector2d wrong = back *
                                    (taken(p, kStep * source, turn, Parameters::Zero()) -
                                     taken(p, -kStep * source, turn, Parameters::Zero())) /
                                    (2 * kStep);
      normal += weight * slopes.transpose() * slopes;
      right -= weight * slopes.transpose() * wrong;
    }
  }
  return normal.ldlt().solve(right);
}

TEST(SphereErrors, AreWhatAWrongSourceDoes) {
  const SphereGuess truth = motion({3, -25, 12}, 0, 0);
  for (const Eigen::Vector3d& source :
       {Eigen::Vector3d(0, 0, 0.2), Eigen::Vector3d(0.1, 0, 0), Eigen::Vector3d(0, 0.1, 0)}) {
    const Parameters off = found_off(truth.turn, source);
    RigidMotion stated;
    const Eigen::Vector3d turn = rotation_vector(truth.turn);
    stated.rot_x_rad = turn.x();
    stated.rot_y_rad = turn.y();
    stated.rot_rad = turn.z();
    stated.dx_sd_px = stated.dy_sd_px = 1e-9;
    stated.rot_x_sd_rad = stated.rot_y_sd_rad = stated.rot_sd_rad = 1e-11;
    add_source_errors(stated, {kRadius, source.z(), source.x(), source.y()});
    const auto like = [](double found, double said, double least) {
      EXPECT_NEAR(std::abs(found), said, 0.05 * said + least);
    };
    like(off(0), stated.dx_sd_px, 0.001);
    like(off(1), stated.dy_sd_px, 0.001);
    like(off(2), stated.rot_x_sd_rad, 1e-5);
    like(off(3), stated.rot_y_sd_rad, 1e-5);
    like(off(4), stated.rot_sd_rad, 1e-5);
  }
}

}  // namespace
}  // namespace impactdic::dic
