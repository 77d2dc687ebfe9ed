// A ball that has come round shows a keyframe's face again: by how much the chain of registrations
// in between missed it tells the radius, the distance and the chain's noise.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "host/motion/pose/linked_pose.h"

namespace impactdic::motion {

// What the same frame, reached by two chains, tells of all poses in between: `along` from frame to
// frame, `closed` from the old keyframe `from`, from which `along` has come, too. Bayes' rule with
// the deviations of radius and distance so far and the chain's noise, on the turn about three axes
// (Kalman 1960). Both do nearly the same to a chain: what is learnt is what they do together. What
// they leave of it is the chain's noise, of which each pose in between has its part.
class TurnClosure {
 public:
  // Empty where the chains say nothing new of radius and distance, or miss each other by more than
  // these and noise explain.
  static std::optional<TurnClosure> of(const LinkedPose& along, const LinkedPose& closed,
                                       const LinkedPose& from, const SphereRadius& radius);

  // As they are thought to be now.
  const SphereRadius& radius() const { return now_; }

  // A pose of before without what is known of its errors now.
  LinkedPose corrected(LinkedPose pose) const;

 private:
  SphereRadius before_, now_;
  LinkedPose from_;
  // In the ball's axes: what each source of errors did to how the chains miss each other, by how
  // much these do, rad, and the inverse of its covariance.
  Eigen::Matrix3d effects_;
  Eigen::Vector3d missed_;
  Eigen::Matrix3d information_;
};

}  // namespace impactdic::motion
