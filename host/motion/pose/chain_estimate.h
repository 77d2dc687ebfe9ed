// One estimate of all keyframes of a chain that has closed: their turns, where their circles lie
// off the ball, the radius and the distance, out of all links at once.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "host/motion/pose/chain_link.h"
#include "host/motion/pose/keyframe_plan.h"
#include "host/motion/pose/linked_pose.h"

namespace impactdic::motion {

// Linear least squares (Bayes' rule with what is known beforehand of circles, radius and distance),
// about the keyframes' poses as they are. A circle errs as the ink under its rim lies, by 0.01 px;
// neighbours' shifts are known ten times better, so that all circles of a turn together tell where
// each ball is: what a circle that lies off the ball does to a link is the largest error of a
// chain.
class ChainEstimate {
 public:
  struct Key {
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();  // further than thought, camera axes, rad
    Eigen::Matrix3d turn_covariance = Eigen::Matrix3d::Zero();
    Eigen::Vector2d off = Eigen::Vector2d::Zero();  // the circle's centre from the ball's, px
    double off_sd_px = 0;
  };

  // The last link is the one that closes. Empty where it does not go with the others by more than
  // chance.
  static std::optional<ChainEstimate> of(std::span<const Keyframe> keyframes,
                                         std::span<const ChainLink> links,
                                         const SphereRadius& radius);

  const std::vector<Key>& keys() const { return keys_; }  // as the keyframes
  const SphereRadius& radius() const { return radius_; }

 private:
  std::vector<Key> keys_;
  SphereRadius radius_;
};

}  // namespace impactdic::motion
