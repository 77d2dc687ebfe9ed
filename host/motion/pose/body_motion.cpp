#include "host/motion/pose/body_motion.h"

#include <algorithm>
#include <cmath>

#include "host/dic/sphere/rotation.h"
#include "host/motion/estimators.h"
#include "host/sphere/source_response.h"

namespace impactdic::motion {
namespace {

Eigen::Quaterniond turn_of(const dic::RigidMotion& motion) {
  return dic::quaternion_of({motion.rot_x_rad, motion.rot_y_rad, motion.rot_rad});
}

// What a px of the radius, a unit of the radius over the distance, or a px by which the circle lies
// off the ball does to a sphere's motion.
struct Effect {
  double x = 0, y = 0;
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();
};
struct Effects {
  Effect radius, nearness;
  std::array<Effect, 2> off;
};

// Of a motion from the ball in `circle`.
Effects effects_on(const dic::RigidMotion& motion, const Circle& circle,
                   const SphereRadius& radius) {
  const Perspective& seen = radius.perspective;
  const auto response = sphere::source_response(
      {{motion.rot_x_rad, motion.rot_y_rad, motion.rot_rad},
       radius.px,
       seen.aside_px(circle.cx_px, circle.cy_px),
       seen.aside_px(circle.cx_px + motion.dx_px, circle.cy_px + motion.dy_px),
       radius.light});
  const auto of = [&](std::size_t source) {
    const auto by = [&](const sphere::SourceResponse::ToSources& to) {
      return std::isfinite(to[source]) ? to[source] : 0.0;
    };
    return Effect{by(response.dx),
                  by(response.dy),
                  {by(response.rot_x), by(response.rot_y), by(response.rot_z)}};
  };
  return {of(sphere::kToRadius), of(sphere::kToNearness), {of(0), of(1)}};
}

// Deviations without the part of one source, known to `source_sd`.
dic::RigidMotion without(const Effect& effect, double source_sd, dic::RigidMotion motion) {
  const auto strip = [&](double& sd, double by_source) {
    const double part = by_source * source_sd;
    sd = std::sqrt(std::max(0.0, sd * sd - part * part));
  };
  strip(motion.dx_sd_px, effect.x);
  strip(motion.dy_sd_px, effect.y);
  strip(motion.rot_x_sd_rad, effect.turn_rad.x());
  strip(motion.rot_y_sd_rad, effect.turn_rad.y());
  strip(motion.rot_sd_rad, effect.turn_rad.z());
  return motion;
}

dic::RigidMotion less(dic::RigidMotion motion, const Effect& effect, double error) {
  if (error == 0) return motion;
  const Eigen::Vector3d turn = dic::rotation_vector(
      dic::quaternion_of(Eigen::Vector3d(-error * effect.turn_rad)) * turn_of(motion));
  motion.rot_x_rad = turn.x();
  motion.rot_y_rad = turn.y();
  motion.rot_rad = turn.z();
  motion.dx_px -= error * effect.x;
  motion.dy_px -= error * effect.y;
  return motion;
}

// What the motion is with the radius and the distance as they are thought to be.
dic::RigidMotion corrected(const dic::RigidMotion& motion, const Effects& effects,
                           const SphereRadius& radius) {
  return less(less(motion, effects.radius, radius.error_px), effects.nearness,
              radius.nearness_error);
}

// Of a sphere, a link whose deviations are its noise's.
LinkedPose with_link(const LinkedPose& pose, const Circle& circle, const dic::RigidMotion& motion,
                     const Effects& effects) {
  LinkedPose next = pose;
  static_cast<BodyPose&>(next) = moved(pose, circle, motion);
  next.radius_x += effects.radius.x;
  next.radius_y += effects.radius.y;
  next.nearness_x += effects.nearness.x;
  next.nearness_y += effects.nearness.y;
  // An error made before turns along with the ball.
  const Eigen::Matrix3d q = turn_of(motion).toRotationMatrix();
  const auto carry = [&](std::array<double, 3>& turn_rad, const Effect& effect) {
    Eigen::Map<Eigen::Vector3d> by(turn_rad.data());
    by = (q * by + effect.turn_rad).eval();
  };
  carry(next.radius_turn_rad, effects.radius);
  carry(next.nearness_turn_rad, effects.nearness);
  Eigen::Map<Eigen::Matrix3d> noise(next.turn_noise_rad2.data());
  const Eigen::Vector3d own(motion.rot_x_sd_rad, motion.rot_y_sd_rad, motion.rot_sd_rad);
  noise = (q * noise * q.transpose()).eval();
  noise.diagonal() += own.cwiseAbs2();
  next.x_sd_px = std::hypot(pose.x_sd_px, motion.dx_sd_px);
  next.y_sd_px = std::hypot(pose.y_sd_px, motion.dy_sd_px);
  return next;
}

}  // namespace

bool is_sphere(const BodyPose& pose) {
  return std::isfinite(pose.qw) && std::isnan(pose.angle_rad);
}

Eigen::Quaterniond orientation(const BodyPose& pose) {
  return Eigen::Quaterniond(pose.qw, pose.qx, pose.qy, pose.qz);
}

void set_orientation(BodyPose& pose, const Eigen::Quaterniond& turn) {
  pose.qw = turn.w();
  pose.qx = turn.x();
  pose.qy = turn.y();
  pose.qz = turn.z();
}

Eigen::Quaterniond turn_between(const BodyPose& from, const BodyPose& to) {
  return orientation(to) * orientation(from).conjugate();
}

double tilt_between(const BodyPose& from, const BodyPose& to) {
  const double facing = turn_between(from, to).toRotationMatrix()(2, 2);
  return std::acos(std::clamp(facing, -1.0, 1.0));
}

Point turned(double x, double y, const Eigen::Quaterniond& turn) {
  const Eigen::Vector3d to = dic::in_picture(turn) * Eigen::Vector3d(x, y, 0);
  return {to.x(), to.y()};
}

Point turned(double x, double y, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * x + s * y, -s * x + c * y};
}

Eigen::Matrix3d turn_covariance(const LinkedPose& pose, const SphereRadius& radius) {
  Eigen::Matrix<double, 3, 2> effects;
  effects << Eigen::Vector3d(pose.radius_turn_rad.data()) * radius.sd_px,
      Eigen::Vector3d(pose.nearness_turn_rad.data()) * radius.nearness_sd();
  Eigen::Matrix2d together = Eigen::Matrix2d::Identity();
  together(0, 1) = together(1, 0) = radius.correlation;
  return Eigen::Matrix3d(pose.turn_noise_rad2.data()) + effects * together * effects.transpose();
}

BodyPose LinkedPose::stated(const SphereRadius& radius) const {
  BodyPose pose = *this;
  if (!is_sphere(*this)) return pose;
  // What radius and distance make together.
  const auto common = [&](double by_radius, double by_nearness) {
    const double a = by_radius * radius.sd_px, b = by_nearness * radius.nearness_sd();
    return std::sqrt(std::max(0.0, a * a + b * b + 2 * radius.correlation * a * b));
  };
  const auto turn = [&](std::size_t axis) {
    return common(radius_turn_rad[axis], nearness_turn_rad[axis]);
  };
  const auto about = [&](std::size_t axis) {
    return std::sqrt(turn_noise_rad2[4 * axis] + std::pow(turn(axis), 2));
  };
  pose.x_sd_px = std::hypot(x_sd_px, common(radius_x, nearness_x));
  pose.y_sd_px = std::hypot(y_sd_px, common(radius_y, nearness_y));
  pose.tilt_x_sd_rad = about(0);
  pose.tilt_y_sd_rad = about(1);
  // What is the same in all links may add up to a tilt whose square counts.
  const double tilt_rad = std::hypot(turn(0), turn(1));
  pose.angle_sd_rad = std::hypot(about(2), tilt_rad * tilt_rad / 2);
  return pose;
}

BodyPose moved(const BodyPose& pose, const Circle& circle, const dic::RigidMotion& motion) {
  BodyPose next = pose;
  next.key_dx_px = next.key_dy_px = kNotMeasured;
  next.key_rot_x_deg = next.key_rot_y_deg = next.key_rot_deg = kNotMeasured;
  Point arm{pose.x_px - circle.cx_px, pose.y_px - circle.cy_px};
  if (is_sphere(pose)) {
    arm = turned(arm.x, arm.y, turn_of(motion));
    set_orientation(next, (turn_of(motion) * orientation(pose)).normalized());
  } else {
    arm = turned(arm.x, arm.y, motion.rot_rad);
    next.angle_rad = pose.angle_rad + motion.rot_rad;
  }
  next.x_px = circle.cx_px + motion.dx_px + arm.x;
  next.y_px = circle.cy_px + motion.dy_px + arm.y;
  return next;
}

LinkedPose linked(const LinkedPose& pose, const Circle& circle, const dic::RigidMotion& motion,
                  const SphereRadius& radius) {
  if (is_sphere(pose)) {
    const Effects effects = effects_on(motion, circle, radius);
    const dic::RigidMotion noisy = without(effects.nearness, radius.perspective.nearness_sd,
                                           without(effects.radius, radius.told_sd_px, motion));
    return with_link(pose, circle, corrected(noisy, effects, radius), effects);
  }
  LinkedPose next = pose;
  static_cast<BodyPose&>(next) = moved(pose, circle, motion);
  const double arm_x = next.x_px - circle.cx_px - motion.dx_px;
  const double arm_y = next.y_px - circle.cy_px - motion.dy_px;
  next.x_sd_px = std::hypot(pose.x_sd_px, motion.dx_sd_px, arm_y * motion.rot_sd_rad);
  next.y_sd_px = std::hypot(pose.y_sd_px, motion.dy_sd_px, arm_x * motion.rot_sd_rad);
  next.angle_sd_rad = std::hypot(pose.angle_sd_rad, motion.rot_sd_rad);
  return next;
}

LinkedPose registered(const Anchor& key, const BallMotion& motion, const CropOrigin& from_key,
                      double expected_rad, const SphereRadius& radius) {
  const bool sphere = is_sphere(key.pose);
  dic::RigidMotion rigid = sphere ? sphere_motion(motion) : dic::RigidMotion{};
  rigid.dx_px = motion.dx + from_key.x;
  rigid.dy_px = motion.dy + from_key.y;
  if (sphere) {
    const Effects effects = effects_on(rigid, key.circle, radius);
    const dic::RigidMotion about_ball =
        less(less(rigid, effects.off[0], key.off_px[0]), effects.off[1], key.off_px[1]);
    LinkedPose pose =
        with_link(key.pose, key.circle, corrected(about_ball, effects, radius), effects);
    for (const Effect& off : effects.off) {
      const Eigen::Vector3d turn_rad = key.off_sd_px * off.turn_rad;
      Eigen::Map<Eigen::Matrix3d>(pose.turn_noise_rad2.data()) += turn_rad * turn_rad.transpose();
    }
    pose.key_dx_px = rigid.dx_px;
    pose.key_dy_px = rigid.dy_px;
    pose.key_rot_x_deg = rigid.rot_x_rad * kDegPerRad;
    pose.key_rot_y_deg = rigid.rot_y_rad * kDegPerRad;
    pose.key_rot_deg = rigid.rot_rad * kDegPerRad;
    return pose;
  }
  rigid.rot_rad = motion.rot_rad;
  rigid.dx_sd_px = motion.dx_sd;
  rigid.dy_sd_px = motion.dy_sd;
  rigid.rot_sd_rad = motion.rot_sd_rad;
  correct_turn(key.shape, motion, rigid);
  LinkedPose pose = linked(key.pose, key.circle, rigid, radius);
  pose.angle_rad = expected_rad + std::remainder(pose.angle_rad - expected_rad, 2 * kPi);
  return pose;
}

}  // namespace impactdic::motion
