#include "host/motion/pose/turn_closure.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "host/dic/sphere/rotation.h"
#include "host/motion/pose/body_motion.h"

namespace impactdic::motion {
namespace {

// A closure that leaves the deviation above this share of what it was is not worth a correction.
constexpr double kWorthwhile = 0.7;
// Beyond so many deviations it was something else than the radius.
constexpr double kLikely = 5;
// Registrations err by this share of the turn alike, whatever the radius: foreshortened texture.
constexpr double kForeshortening = 1e-4;

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

Matrix noise_of(const LinkedPose& pose) { return Matrix(pose.turn_noise_rad2.data()); }
Vector by_radius(const LinkedPose& pose) { return Vector(pose.radius_turn_rad.data()); }

}  // namespace

std::optional<SphereRadius> radius_from(const LinkedPose& along, const LinkedPose& closed,
                                        const SphereRadius& radius) {
  const Vector per_px = by_radius(closed) - by_radius(along);
  const Vector missed = dic::rotation_vector(turn_between(along, closed));
  const Matrix information = (noise_of(along) + noise_of(closed)).inverse();
  // A px of the radius makes about twice its share of the turn: the floor, in px.
  const double least_sd_px = 0.5 * kForeshortening * radius.px;
  const double of_closure = per_px.dot(information * per_px);
  const double of_radius = 1 / (radius.sd_px * radius.sd_px);
  const double sd_px = std::max(1 / std::sqrt(of_closure + of_radius), least_sd_px);
  if (!(sd_px < kWorthwhile * radius.sd_px)) return std::nullopt;
  const double error_px = per_px.dot(information * missed) / (of_closure + of_radius);
  const Vector left = missed - per_px * error_px;
  const Vector allowed =
      (noise_of(along) + noise_of(closed)).diagonal().cwiseSqrt() + per_px.cwiseAbs() * least_sd_px;
  const bool likely = std::abs(error_px) <= kLikely * radius.sd_px &&
                      (left.cwiseAbs().array() <= kLikely * allowed.array()).all();
  if (!likely) return std::nullopt;
  SphereRadius better = radius;
  better.error_px += error_px;
  better.sd_px = sd_px;
  return better;
}

LinkedPose with_radius_error(LinkedPose pose, double error_px) {
  if (!is_sphere(pose)) return pose;  // of a frame without a ball
  const Vector less = -error_px * by_radius(pose);
  set_orientation(pose, (dic::quaternion_of(less) * orientation(pose)).normalized());
  pose.x_px -= error_px * pose.radius_x;
  pose.y_px -= error_px * pose.radius_y;
  return pose;
}

}  // namespace impactdic::motion
