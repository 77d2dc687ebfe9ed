#include "sim/speckle/orientation.h"

#include <impactdic/units.h>

#include <cmath>

namespace impactdic::sim::speckle {
namespace {

bool turns_in_plane(const BallPose& pose) { return pose.rx_deg == 0 && pose.ry_deg == 0; }

Eigen::Quaterniond exponential(const Eigen::Vector3d& turn_deg) {
  const double angle = turn_deg.norm() * kRadPerDeg;
  if (angle == 0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn_deg.normalized()));
}

// At most 180 degrees long.
Eigen::Vector3d logarithm(Eigen::Quaterniond turn) {
  turn.normalize();
  if (turn.w() < 0) turn.coeffs() *= -1;
  const double sine = turn.vec().norm();
  // Below 1e-150 the ratio of the two is lost, and the angle with it.
  if (sine < 1e-150) return Eigen::Vector3d::Zero();
  return turn.vec() * (2 * std::atan2(sine, turn.w()) / sine / kRadPerDeg);
}

}  // namespace

Eigen::Quaterniond orientation_of(const BallPose& pose) {
  return exponential({pose.rx_deg, pose.ry_deg, pose.angle_deg});
}

void set_orientation(BallPose& pose, const Eigen::Quaterniond& orientation) {
  const Eigen::Vector3d turn = logarithm(orientation);
  pose.rx_deg = turn.x();
  pose.ry_deg = turn.y();
  pose.angle_deg = turn.z();
}

Eigen::Vector3d turn_between(const BallPose& from, const BallPose& to) {
  if (turns_in_plane(from) && turns_in_plane(to)) return {0, 0, to.angle_deg - from.angle_deg};
  return logarithm(orientation_of(to) * orientation_of(from).conjugate());
}

BallPose part_way(const BallPose& from, const BallPose& to, double t) {
  const auto mix = [t](double a, double b) { return a + t * (b - a); };
  BallPose pose{mix(from.cx_px, to.cx_px), mix(from.cy_px, to.cy_px),
                mix(from.angle_deg, to.angle_deg), mix(from.compression, to.compression),
                mix(from.compression_axis_deg, to.compression_axis_deg)};
  pose.z_px = mix(from.z_px, to.z_px);
  if (!turns_in_plane(from) || !turns_in_plane(to)) {
    set_orientation(pose, exponential(t * turn_between(from, to)) * orientation_of(from));
  }
  return pose;
}

}  // namespace impactdic::sim::speckle
