// Clips through a lens that bends straight lines.
//
// The ball is rendered from formulas on pixels a third as wide, and every pixel of the clip gets
// the mean over its own square at the place where a lens without distortion would show the same.
// The fine picture is smooth (its blur is three times the scene's in its own pixels), so that
// interpolation of six points a side leaves 1e-3 grey levels.
#pragma once

#include <memory>

#include "sim/speckle/render.h"
#include "sim/speckle/render_parts.h"
#include "sim/speckle/sphere/sphere.h"

namespace impactdic::sim::speckle {

// How many fine pixels a pixel of the clip is wide.
inline constexpr int kFiner = 3;

bool bends(const SynthScene& scene);
// Where a lens without distortion would show what the scene's lens shows at a point of the picture,
// by Newton's method on r' = r (1 + k1 q^2 + k2 q^4), q = r over half of the picture's diagonal;
// px.
Vec straightened(const SynthScene& scene, const Vec& point_px);

// The same with pixels a third as wide.
SynthScene finer(SynthScene scene);
SpeckleBall finer(SpeckleBall ball);
SpeckleSphere finer(SpeckleSphere sphere);

class BentRenderer : public FrameRenderer {
 public:
  // `fine` renders the finer ball in the finer scene.
  BentRenderer(std::unique_ptr<FrameRenderer> fine, const SynthScene& scene);

  Image<double> exact(const ShutterPath& path) const override;
  using FrameRenderer::render;
  void render(const ShutterPath& path, std::int64_t frame_index, Frame& out) const override;

 private:
  std::unique_ptr<FrameRenderer> fine_;
  SynthScene scene_;
  std::vector<Vec> places_;  // of every pixel in the fine picture
};

}  // namespace impactdic::sim::speckle
