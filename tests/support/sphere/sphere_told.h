// What pictures of a sphere that turns far tell of its radius and of their blur: what tests share.
#pragma once

#include <algorithm>
#include <optional>

#include "host/advice/sphere_radius.h"
#include "tests/support/sphere/sphere_pairs.h"

namespace impactdic::testing {

// How the ball is seen, how far its first circle lies to the right of it and as much above it, and
// the share of a lamp that stands 20 degrees towards the camera.
struct FarView {
  double psf_sigma_px = 0.6;
  double off_px = 0;
  double lamp_share = 0;
};

// What sphere_from_turn tells of a ball of 115 px that turns by 5 degrees a frame about an axis in
// the picture, noise 2.
inline std::optional<advice::SphereTold> told_by_turns(const FarView& view, unsigned seed) {
  constexpr int kFrames = 6;
  SynthScene scene;
  scene.width = scene.height = kSide;
  scene.psf_sigma_px = view.psf_sigma_px;
  scene.noise_sigma = 2;
  scene.noise_seed = seed;
  scene.lamp_share = view.lamp_share;
  scene.lamp_elevation_deg = 20;
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
  first.ball.cx_px += view.off_px;
  first.ball.cy_px -= view.off_px;
  first.ball.centre_sd_px = std::max(first.ball.centre_sd_px, view.off_px);
  const advice::BallPair pair{0, first.picture, second.picture, first.ball, second.ball};
  advice::FarFrames frames;
  frames.count = kFrames;
  frames.find = [&](std::int64_t index, const Circle&) { return std::optional(seen(index)); };
  dic::RigidMotion step;
  step.dx_px = 0.4;
  step.dy_px = -0.3;
  step.rot_x_rad = turn.x();
  step.rot_y_rad = turn.y();
  return advice::sphere_from_turn(shared_engine(), pair, step, {}, frames);
}

}  // namespace impactdic::testing
