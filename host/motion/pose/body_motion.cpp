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

// What a px of the radius does to a sphere's motion.
struct RadiusEffect {
  double x = 0, y = 0;
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();
};

RadiusEffect effect_on(const dic::RigidMotion& motion, double radius_px) {
  const auto response =
      sphere::source_response({motion.rot_x_rad, motion.rot_y_rad, motion.rot_rad}, radius_px);
  const auto of = [&](const sphere::SourceResponse::ToSources& to) {
    const double effect = to[sphere::kToRadius];
    return std::isfinite(effect) ? effect : 0.0;
  };
  return {of(response.dx),
          of(response.dy),
          {of(response.rot_x), of(response.rot_y), of(response.rot_z)}};
}

// Deviations without the radius's part.
dic::RigidMotion without(const RadiusEffect& effect, double radius_sd_px, dic::RigidMotion motion) {
  const auto strip = [&](double& sd, double by_radius) {
    const double part = by_radius * radius_sd_px;
    sd = std::sqrt(std::max(0.0, sd * sd - part * part));
  };
  strip(motion.dx_sd_px, effect.x);
  strip(motion.dy_sd_px, effect.y);
  strip(motion.rot_x_sd_rad, effect.turn_rad.x());
  strip(motion.rot_y_sd_rad, effect.turn_rad.y());
  strip(motion.rot_sd_rad, effect.turn_rad.z());
  return motion;
}

// What the motion is with the radius as it is thought to be.
dic::RigidMotion corrected(dic::RigidMotion motion, const RadiusEffect& effect, double error_px) {
  if (error_px == 0) return motion;
  const Eigen::Vector3d less = -error_px * effect.turn_rad;
  const Eigen::Vector3d turn = dic::rotation_vector(dic::quaternion_of(less) * turn_of(motion));
  motion.rot_x_rad = turn.x();
  motion.rot_y_rad = turn.y();
  motion.rot_rad = turn.z();
  motion.dx_px -= error_px * effect.x;
  motion.dy_px -= error_px * effect.y;
  return motion;
}

// Of a sphere, a link whose deviations are its noise's.
LinkedPose with_link(const LinkedPose& pose, const Circle& circle, const dic::RigidMotion& motion,
                     const RadiusEffect& effect) {
  LinkedPose next = pose;
  static_cast<BodyPose&>(next) = moved(pose, circle, motion);
  next.radius_x += effect.x;
  next.radius_y += effect.y;
  // An error made before turns along with the ball.
  const Eigen::Matrix3d q = turn_of(motion).toRotationMatrix();
  Eigen::Map<Eigen::Vector3d> by_radius(next.radius_turn_rad.data());
  by_radius = (q * by_radius + effect.turn_rad).eval();
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

BodyPose LinkedPose::stated(double radius_sd_px) const {
  BodyPose pose = *this;
  if (!is_sphere(*this)) return pose;
  const auto about = [&](std::size_t axis) {
    return std::hypot(std::sqrt(turn_noise_rad2[4 * axis]), radius_turn_rad[axis] * radius_sd_px);
  };
  pose.x_sd_px = std::hypot(x_sd_px, radius_x * radius_sd_px);
  pose.y_sd_px = std::hypot(y_sd_px, radius_y * radius_sd_px);
  pose.tilt_x_sd_rad = about(0);
  pose.tilt_y_sd_rad = about(1);
  pose.angle_sd_rad = about(2);
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
    const RadiusEffect effect = effect_on(motion, radius.px);
    const dic::RigidMotion noisy = without(effect, radius.told_sd_px, motion);
    return with_link(pose, circle, corrected(noisy, effect, radius.error_px), effect);
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
  dic::RigidMotion rigid = sphere ? sphere_motion(motion, 0) : dic::RigidMotion{};
  rigid.dx_px = motion.dx + from_key.x;
  rigid.dy_px = motion.dy + from_key.y;
  if (sphere) {
    const RadiusEffect effect = effect_on(rigid, radius.px);
    LinkedPose pose =
        with_link(key.pose, key.circle, corrected(rigid, effect, radius.error_px), effect);
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
