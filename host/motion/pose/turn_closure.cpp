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
// Beyond so many deviations it was something else than radius and distance.
constexpr double kLikely = 5;
// Registrations err by this share of the turn alike, whatever the radius: foreshortened texture
// (poses of six clips of 600 and 2000 frames err by 0.35 to 0.71 of what is then stated).
constexpr double kForeshortening = 4e-5;

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;
using SourceEffects = Eigen::Matrix<double, 3, 2>;  // of radius and distance on a turn

Matrix noise_of(const LinkedPose& pose) { return Matrix(pose.turn_noise_rad2.data()); }

SourceEffects source_effects(const LinkedPose& pose) {
  SourceEffects effects;
  effects << Vector(pose.radius_turn_rad.data()), Vector(pose.nearness_turn_rad.data());
  return effects;
}

Eigen::Matrix2d covariance_of(const SphereRadius& radius) {
  const Eigen::Vector2d sd(radius.sd_px, radius.nearness_sd());
  Eigen::Matrix2d correlations;
  correlations << 1, radius.correlation, radius.correlation, 1;
  return sd.asDiagonal() * correlations * sd.asDiagonal();
}

SphereRadius with_covariance(SphereRadius radius, const Eigen::Matrix2d& covariance) {
  const Eigen::Vector2d sd = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  radius.sd_px = sd[0];
  const double told = radius.perspective.nearness_sd, both = sd[0] * sd[1];
  radius.nearness_share = told > 0 ? sd[1] / told : 1;
  radius.correlation = both > 0 ? std::clamp(covariance(0, 1) / both, -1.0, 1.0) : 0;
  return radius;
}

}  // namespace

std::optional<SphereRadius> radius_from(const LinkedPose& along, const LinkedPose& closed,
                                        const SphereRadius& radius) {
  const SourceEffects effects = source_effects(closed) - source_effects(along);
  const Vector missed = dic::rotation_vector(turn_between(along, closed));
  // A px of the radius makes about twice its share of the turn.
  const Vector foreshortened = 0.5 * kForeshortening * radius.px * effects.col(0);
  const Matrix chance =
      noise_of(along) + noise_of(closed) + foreshortened * foreshortened.transpose();
  const Eigen::Matrix2d prior = covariance_of(radius);
  const Matrix expected = effects * prior * effects.transpose();
  const Matrix information = (expected + chance).inverse();
  const Eigen::Matrix<double, 2, 3> gain = prior * effects.transpose() * information;
  const Eigen::Matrix2d posterior = prior - gain * effects * prior;
  const double left_open = (effects * posterior * effects.transpose()).trace();
  if (!(left_open < kWorthwhile * kWorthwhile * expected.trace())) return std::nullopt;
  const Eigen::Vector2d errors = gain * missed;
  const Vector left = missed - effects * errors;
  const Vector allowed = kLikely * chance.diagonal().cwiseSqrt();
  const bool likely = missed.dot(information * missed) <= kLikely * kLikely &&
                      (left.cwiseAbs().array() <= allowed.array()).all();
  if (!likely) return std::nullopt;
  SphereRadius better = with_covariance(radius, posterior);
  better.error_px += errors[0];
  better.nearness_error += errors[1];
  return better;
}

LinkedPose with_errors(LinkedPose pose, const SphereRadius& before, const SphereRadius& now) {
  if (!is_sphere(pose)) return pose;  // of a frame without a ball
  const double px = now.error_px - before.error_px;
  const double nearness = now.nearness_error - before.nearness_error;
  const Vector less = -source_effects(pose) * Eigen::Vector2d(px, nearness);
  set_orientation(pose, (dic::quaternion_of(less) * orientation(pose)).normalized());
  pose.x_px -= px * pose.radius_x + nearness * pose.nearness_x;
  pose.y_px -= px * pose.radius_y + nearness * pose.nearness_y;
  return pose;
}

}  // namespace impactdic::motion
