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
// (poses of six clips of 600 and 2000 frames then err by 0.52 to 1.39 of what is stated).
constexpr double kForeshortening = 4e-5;

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

// All in the ball's axes: there an error of a turn stays the same along a chain.
Matrix to_ball(const LinkedPose& pose) { return orientation(pose).conjugate().toRotationMatrix(); }

Matrix noise_of(const LinkedPose& pose) {
  return to_ball(pose) * Matrix(pose.turn_noise_rad2.data()) * to_ball(pose).transpose();
}

// Of a px of the radius, of a unit of the radius over the distance, and of foreshortening, which
// errs as a part of the radius does: a px of that makes about twice its share of the turn.
Matrix effects_on(const LinkedPose& pose, const SphereRadius& radius) {
  const Vector by_radius(pose.radius_turn_rad.data()), by_nearness(pose.nearness_turn_rad.data());
  Matrix effects;
  effects << by_radius, by_nearness, 0.5 * kForeshortening * radius.px * by_radius;
  return to_ball(pose) * effects;
}

// Of radius, radius over distance, and foreshortening, which is no part of the radius's errors.
Matrix covariance_of(const SphereRadius& radius) {
  const Vector sd(radius.sd_px, radius.nearness_sd(), 1);
  Matrix correlations = Matrix::Identity();
  correlations(0, 1) = correlations(1, 0) = radius.correlation;
  return sd.asDiagonal() * correlations * sd.asDiagonal();
}

// Of both sources that poses state.
Matrix stated_of(const Matrix& effects, const Matrix& covariance) {
  return effects.leftCols<2>() * covariance.topLeftCorner<2, 2>() *
         effects.leftCols<2>().transpose();
}

SphereRadius with_covariance(SphereRadius radius, const Matrix& covariance) {
  const Vector sd = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  radius.sd_px = sd[0];
  const double told = radius.perspective.nearness_sd, both = sd[0] * sd[1];
  radius.nearness_share = told > 0 ? sd[1] / told : 1;
  radius.correlation = both > 0 ? std::clamp(covariance(0, 1) / both, -1.0, 1.0) : 0;
  return radius;
}

}  // namespace

std::optional<TurnClosure> TurnClosure::of(const LinkedPose& along, const LinkedPose& closed,
                                           const LinkedPose& from, const SphereRadius& radius) {
  const Matrix effects = effects_on(closed, radius) - effects_on(along, radius);
  const Vector missed = to_ball(closed) * dic::rotation_vector(turn_between(along, closed));
  const Matrix noise = noise_of(along) + noise_of(closed) - 2 * noise_of(from);
  const Matrix prior = covariance_of(radius);
  const Matrix information = (effects * prior * effects.transpose() + noise).inverse();
  const Matrix gain = prior * effects.transpose() * information;
  const Matrix posterior = prior - gain * effects * prior;
  const double left_open = stated_of(effects, posterior).trace();
  if (!(left_open < kWorthwhile * kWorthwhile * stated_of(effects, prior).trace())) {
    return std::nullopt;
  }
  const Vector errors = gain * missed;
  const Vector left = missed - effects.leftCols<2>() * errors.head<2>();
  const Matrix chance = noise + effects.col(2) * effects.col(2).transpose();
  const Vector allowed = kLikely * chance.diagonal().cwiseSqrt();
  const bool likely = missed.dot(information * missed) <= kLikely * kLikely &&
                      (left.cwiseAbs().array() <= allowed.array()).all();
  if (!likely) return std::nullopt;
  TurnClosure closure;
  closure.before_ = radius;
  closure.now_ = with_covariance(radius, posterior);
  closure.now_.error_px += errors[0];
  closure.now_.nearness_error += errors[1];
  closure.from_ = from;
  closure.effects_ = effects;
  closure.missed_ = missed;
  closure.information_ = information;
  return closure;
}

LinkedPose TurnClosure::corrected(LinkedPose pose) const {
  if (!is_sphere(pose)) return pose;  // of a frame without a ball
  const Matrix effects = effects_on(pose, before_), prior = covariance_of(before_);
  // How the pose's error goes along with what the chains missed each other by.
  const Matrix along = effects * prior * effects_.transpose() - (noise_of(pose) - noise_of(from_));
  const Vector error = along * information_ * missed_;
  const Matrix left =
      effects * prior * effects.transpose() - along * information_ * along.transpose();
  const Matrix to_camera = to_ball(pose).transpose();
  Eigen::Map<Matrix>(pose.turn_told_rad2.data()) +=
      to_camera * (stated_of(effects, covariance_of(now_)) - left) * to_camera.transpose();
  set_orientation(pose, (orientation(pose) * dic::quaternion_of(Vector(-error))).normalized());
  const double px = now_.error_px - before_.error_px;
  const double nearness = now_.nearness_error - before_.nearness_error;
  pose.x_px -= px * pose.radius_x + nearness * pose.nearness_x;
  pose.y_px -= px * pose.radius_y + nearness * pose.nearness_y;
  return pose;
}

}  // namespace impactdic::motion
