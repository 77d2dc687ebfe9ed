// Rendered frames of a speckled ball for tests.
#pragma once

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

inline std::vector<Frame> render_frames(const SpeckleBall& ball, const Scene& scene,
                                        const std::vector<BallPose>& poses) {
  const BallRenderer renderer(ball, scene);
  std::vector<Frame> frames(poses.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    renderer.render(poses[k], static_cast<std::int64_t>(k), frames[k]);
  }
  return frames;
}

}  // namespace impactdic::testing
