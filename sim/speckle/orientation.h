// Turns of a sphere. Camera axes: X right, Y up, Z towards the camera.
#pragma once

#include <impactdic/synth.h>

#include <Eigen/Geometry>

namespace impactdic::sim::speckle {

// Ball axes to camera axes: exp of the pose's rotation vector.
Eigen::Quaterniond orientation_of(const BallPose& pose);

// Sets the pose's rotation vector, at most 180 degrees long.
void set_orientation(BallPose& pose, const Eigen::Quaterniond& orientation);

// The rotation vector in camera axes, degrees, that turns the pose `from` into `to`. Where both
// turn in the picture's plane only it is the difference of their angles, whole turns included;
// else it is at most 180 degrees long.
Eigen::Vector3d turn_between(const BallPose& from, const BallPose& to);

// The pose after the share `t` (any number) of a motion from `from` to `to`: a straight line, and a
// turn about a fixed axis.
BallPose part_way(const BallPose& from, const BallPose& to, double t);

}  // namespace impactdic::sim::speckle
