// What blurs the pictures of a sphere that turns far, learnt from two of them: what tests share.
#pragma once

#include <algorithm>
#include <optional>

#include "host/advice/sphere_radius.h"
#include "tests/support/sphere/sphere_pairs.h"

namespace impactdic::testing {

// What sphere_from_turn tells of a ball of 115 px that turns by 5 degrees a frame about an axis in
// the picture, seen through a lens of this point spread function, noise 2, its first circle so far
// to the right of the ball and as much above it.
inline std::optional<advice::SphereTold> told_through(double psf_sigma_px, unsigned seed,
                                                      double off_px = 0) {
  constexpr int kFrames = 6;
  SynthScene scene;
  scene.width = scene.height = kSide;
  scene.psf_sigma_px = psf_sigma_px;
  scene.noise_sigma = 2;
  scene.noise_seed = seed;
  const sim::speckle::SphereRenderer sphere(sim::speckle::paint_sphere("e1", seed, kRadiusPx),
                                            scene);
  const Eigen::Vector3d turn = Eigen::Vector3d(0.6, 0.8, 0) * 5 * kRadPerDeg;
  const auto seen = [&](std::int64_t index) {
    const double at = static_cast<double>(index);
    BallPose pose{149.7 + 0.4 * at, 150.2 - 0.3 * at};
    sim::speckle::set_orientation(pose, dic::quaternion_of(at * turn));
    advice::BallPicture made{{}, {{pose.cx_px, pose.cy_px, kRadiusPx}, 0.01}};
    sphere.render(pose, index, made.picture);
    return made;
  };
  advice::BallPicture first = seen(0);
  const advice::BallPicture second = seen(1);
  first.ball.cx_px += off_px;
  first.ball.cy_px -= off_px;
  first.ball.centre_sd_px = std::max(first.ball.centre_sd_px, off_px);
  const advice::BallPair pair{0, first.picture, second.picture, first.ball, second.ball};
  const advice::FarFrames frames{
      kFrames, [&](std::int64_t index, const Circle&) { return std::optional(seen(index)); }};
  dic::RigidMotion step;
  step.dx_px = 0.4;
  step.dy_px = -0.3;
  step.rot_x_rad = turn.x();
  step.rot_y_rad = turn.y();
  return advice::sphere_from_turn(shared_engine(), pair, step, {}, {}, frames);
}

}  // namespace impactdic::testing
