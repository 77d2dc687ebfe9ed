// Rendered frames of a speckled ball for tests.
#pragma once

#include <random>
#include <vector>

#include "sim/speckle/render.h"

namespace impactdic::testing {

inline BallPose pose(double cx_px, double cy_px, double angle_deg) {
  BallPose out;
  out.cx_px = cx_px;
  out.cy_px = cy_px;
  out.angle_deg = angle_deg;
  return out;
}

// A ball with discs of radius 1.6 … 4 px thrown at random, about half of it ink: much quicker to
// paint than the patterns of the study.
inline sim::speckle::SpeckleBall quick_ball(unsigned seed, double radius_px) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  sim::speckle::SpeckleBall ball;
  ball.radius_px = radius_px;
  for (double area = 0; area < 0.7 * radius_px * radius_px;) {
    const double x = radius_px * (2 * uniform() - 1), y = radius_px * (2 * uniform() - 1);
    const double radius = 1.6 + 2.4 * uniform();
    if (x * x + y * y > radius_px * radius_px) continue;
    ball.discs.push_back({x, y, radius});
    area += radius * radius;
  }
  return ball;
}

inline std::vector<Frame> render_frames(const sim::speckle::SpeckleBall& ball,
                                        const SynthScene& scene,
                                        const std::vector<BallPose>& poses) {
  const sim::speckle::BallRenderer renderer(ball, scene);
  std::vector<Frame> frames(poses.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    renderer.render(poses[k], static_cast<std::int64_t>(k), frames[k]);
  }
  return frames;
}

}  // namespace impactdic::testing
