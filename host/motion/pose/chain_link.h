// What one registration, or several in a row, say of how one keyframe's ball lies to another's,
// with all that such a measurement errs by.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "host/circle/circle.h"
#include "host/dic/rigid_fit.h"
#include "host/motion/pose/linked_pose.h"

namespace impactdic::motion {

// From keyframe to keyframe (frame numbers), as registrations say it with the radius and the
// circles that they were told. Shifts px, x right and y down; turns rad about X, Y and Z, in that
// order in each list of five.
struct ChainLink {
  std::int64_t from = -1, to = -1;
  std::array<double, 3> turn_rad{};     // rotation vector
  std::array<double, 2> shift_px{};     // of the circles' centres
  std::array<double, 15> covariance{};  // of noise: lower triangle, row by row
  // What a px by which a keyframe's circle lies to the right of the ball makes of them, and one
  // down (pairs); a px of the radius, a unit of the radius over the distance.
  std::array<double, 10> by_from{}, by_to{};
  std::array<double, 5> by_radius{}, by_nearness{};
};

// A registration as it was measured, of the ball in `circle`.
struct ChainStep {
  dic::RigidMotion motion;
  Circle circle;
};

// Puts registrations together: from a keyframe to a frame, on to the next one, back to another
// keyframe.
class ChainLinkMaker {
 public:
  explicit ChainLinkMaker(const SphereRadius& radius) : radius_(radius) {}

  // From the keyframe on.
  ChainLinkMaker& first(const ChainStep& step) { return then(step, true); }
  // On from frame to frame: turns by so little that what the circle errs by does not count.
  ChainLinkMaker& next(const ChainStep& step) { return then(step, false); }
  // To the keyframe from which `step` leads here.
  ChainLinkMaker& back(const ChainStep& step);

  // `covariance`: of one of the registrations, which all err by about as much; in noise that is
  // their own, not their pictures'.
  ChainLink link(std::int64_t from, std::int64_t to,
                 const std::array<double, 15>& covariance) const;

 private:
  using Effects = Eigen::Matrix<double, 5, 2>;
  // To the centre, and to radius and nearness.
  struct Errors {
    Effects centre, common;
  };
  Errors errors_of(const ChainStep& step) const;
  ChainLinkMaker& then(const ChainStep& step, bool of_keyframe);

  SphereRadius radius_;
  int steps_ = 0;
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  Eigen::Vector2d shift_ = Eigen::Vector2d::Zero();
  Effects from_ = Effects::Zero(), to_ = Effects::Zero(), common_ = Effects::Zero();
};

}  // namespace impactdic::motion
