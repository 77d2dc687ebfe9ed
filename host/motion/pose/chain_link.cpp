#include "host/motion/pose/chain_link.h"

#include <cmath>

#include "host/dic/sphere/rotation.h"
#include "host/sphere/source_response.h"

namespace impactdic::motion {
namespace {

// A picture's noise makes the link that ends in it too long and the one that begins there too
// short, so that links in a row err together by no more than this share of what each of them does
// (variance; four balls of 600 frames: 0.06 to 0.1).
constexpr double kOwnNoise = 0.1;

Eigen::Vector3d turn_of(const ChainStep& step) {
  return {step.motion.rot_x_rad, step.motion.rot_y_rad, step.motion.rot_rad};
}
Eigen::Vector2d shift_of(const ChainStep& step) { return {step.motion.dx_px, step.motion.dy_px}; }

}  // namespace

ChainLinkMaker::Errors ChainLinkMaker::errors_of(const ChainStep& step) const {
  const Perspective& seen = radius_.perspective;
  const Circle& at = step.circle;
  const Eigen::Vector3d turn = turn_of(step);
  const auto response = sphere::source_response(
      {{turn.x(), turn.y(), turn.z()},
       radius_.px,
       seen.aside_px(at.cx_px, at.cy_px),
       seen.aside_px(at.cx_px + step.motion.dx_px, at.cy_px + step.motion.dy_px),
       radius_.light});
  const auto of = [&](std::size_t source) {
    Eigen::Matrix<double, 5, 1> by;
    by << response.dx[source], response.dy[source], response.rot_x[source], response.rot_y[source],
        response.rot_z[source];
    if (!by.allFinite()) by.setZero();
    return by;
  };
  Errors errors;
  errors.centre << of(0), of(1);
  errors.common << of(sphere::kToRadius), of(sphere::kToNearness);
  return errors;
}

ChainLinkMaker& ChainLinkMaker::then(const ChainStep& step, bool of_keyframe) {
  const Errors errors = errors_of(step);
  const Eigen::Quaterniond turn = dic::quaternion_of(turn_of(step));
  const Eigen::Matrix3d q = turn.toRotationMatrix();
  for (Effects* effects : {&from_, &to_, &common_}) {
    effects->bottomRows<3>() = (q * effects->bottomRows<3>()).eval();
  }
  if (of_keyframe) from_ += errors.centre;
  common_ += errors.common;
  turn_ = turn * turn_;
  shift_ += shift_of(step);
  ++steps_;
  return *this;
}

ChainLinkMaker& ChainLinkMaker::back(const ChainStep& step) {
  const Errors errors = errors_of(step);
  const Eigen::Quaterniond turn = dic::quaternion_of(turn_of(step)).conjugate();
  const Eigen::Matrix3d q = turn.toRotationMatrix();
  to_ -= errors.centre;
  common_ -= errors.common;
  for (Effects* effects : {&from_, &to_, &common_}) {
    effects->bottomRows<3>() = (q * effects->bottomRows<3>()).eval();
  }
  turn_ = turn * turn_;
  shift_ -= shift_of(step);
  ++steps_;
  return *this;
}

ChainLink ChainLinkMaker::link(std::int64_t from, std::int64_t to,
                               const std::array<double, 15>& covariance) const {
  ChainLink link;
  link.from = from;
  link.to = to;
  Eigen::Map<Eigen::Vector3d>(link.turn_rad.data()) = dic::rotation_vector(turn_);
  Eigen::Map<Eigen::Vector2d>(link.shift_px.data()) = shift_;
  for (std::size_t k = 0; k < covariance.size(); ++k) {
    link.covariance[k] = kOwnNoise * steps_ * covariance[k];
  }
  using RowByRow = Eigen::Matrix<double, 5, 2, Eigen::RowMajor>;
  Eigen::Map<RowByRow>(link.by_from.data()) = from_;
  Eigen::Map<RowByRow>(link.by_to.data()) = to_;
  Eigen::Map<Eigen::Matrix<double, 5, 1>>(link.by_radius.data()) = common_.col(0);
  Eigen::Map<Eigen::Matrix<double, 5, 1>>(link.by_nearness.data()) = common_.col(1);
  return link;
}

}  // namespace impactdic::motion
