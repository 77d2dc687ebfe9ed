// Where motions take a ball's pose: flat balls turn in the picture, spheres about any axis.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "host/circle/circle.h"
#include "host/dic/rigid_fit.h"
#include "host/motion/ball_crop.h"
#include "host/motion/ball_shape.h"
#include "host/motion/pose/linked_pose.h"
#include "kernels/types.h"

namespace impactdic::motion {

struct Point {
  double x, y;
};

// Whether it is a sphere's: with an orientation, without an angle.
bool is_sphere(const BodyPose& pose);
Eigen::Quaterniond orientation(const BodyPose& pose);
void set_orientation(BodyPose& pose, const Eigen::Quaterniond& turn);
// From `from` to `to`, in the camera's axes.
Eigen::Quaterniond turn_between(const BodyPose& from, const BodyPose& to);
// By how much of it the facing side turns away, rad: what foreshortening sees of a turn.
double tilt_between(const BodyPose& from, const BodyPose& to);

// (x, y) px at the depth of the centre, turned in space; y down.
Point turned(double x, double y, const Eigen::Quaterniond& turn);
// (x, y) turned counter-clockwise on the screen, y down.
Point turned(double x, double y, double angle_rad);

// Where the motion to the next frame takes a pose, deviations left as they are; `circle`: of the
// ball before it.
BodyPose moved(const BodyPose& pose, const Circle& circle, const dic::RigidMotion& motion);
// The same with its errors; those of a sphere's `motion` hold the radius's and the distance's.
LinkedPose linked(const LinkedPose& pose, const Circle& circle, const dic::RigidMotion& motion,
                  const SphereRadius& radius);

// Of a sphere's turn with all its errors, camera axes, rad².
Eigen::Matrix3d turn_covariance(const LinkedPose& pose, const SphereRadius& radius);

// A keyframe: its pose, and the ball as it is seen there; by how much its circle is thought to lie
// to the right of the ball and below it, px, and the deviation of that.
struct Anchor {
  const LinkedPose& pose;
  const Circle& circle;
  const BallShape& shape;
  std::array<double, 2> off_px{};
  double off_sd_px = 0;
};
// Of a frame that was registered against a keyframe, its part's corner `from_key` from that one's;
// the turn of a flat ball is the one nearest to `expected_rad`.
LinkedPose registered(const Anchor& key, const BallMotion& motion, const CropOrigin& from_key,
                      double expected_rad, const SphereRadius& radius);

}  // namespace impactdic::motion
