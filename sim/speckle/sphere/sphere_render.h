// Pictures of a speckled sphere, computed from its exact pose: no picture is ever resampled.
//
// The model. Caps and strips of full ink lie on a sphere; what is seen of them is lit, hides the
// background, may be hidden by a bar, and all that goes through the lens (Gaussian) and the pixel's
// square. Along a line of the picture the edges of the ink are known in closed form
// (sphere_view.h), overlaps are joined, and shares of fine cells and their moments are exact; 32
// rows of lines make a pixel row. Lens and pixel are one filter on those cells. Pixels are right
// to 0.02 grey levels rms at σ 0.6 px, single ones at the rim to 0.3
// (tests/unit/sim/sphere_render_test.cpp).
#pragma once

#include <cstdint>
#include <vector>

#include "sim/speckle/render.h"
#include "sim/speckle/sphere/sphere.h"
#include "sim/speckle/sphere/sphere_ink.h"

namespace impactdic::sim::speckle {

// Renders one sphere in one scene. Rendering is const, may be called from several threads, and uses
// all of TBB's threads itself. The result does not depend on their number.
class SphereRenderer : public FrameRenderer {
 public:
  // Throws InvalidArgument for an impossible scene.
  SphereRenderer(SpeckleSphere sphere, const SynthScene& scene);

  // The picture without noise or rounding, grey levels of 255, (height, width).
  // Throws InvalidArgument for a pose that cannot be shown (SphereView).
  Image<double> exact(const BallPose& pose) const;
  Image<double> exact(const ShutterPath& path) const override;

  using FrameRenderer::render;
  void render(const ShutterPath& path, std::int64_t frame_index, Frame& out) const override;

  const SpeckleSphere& sphere() const { return sphere_; }
  const SynthScene& scene() const { return scene_; }

 private:
  struct Columns;  // fine cells of a line
  struct Box {
    int left, right, top, bottom;  // pixels
  };

  Box box_of(const SphereView& view) const;
  std::vector<InkedLine> lines_of(const SphereView& view, double top, int rows) const;
  void add_line(const SphereView& view, InkedLine& line, Columns& cells) const;
  void light_line(const SphereView& view, const SphereLine& line, Columns& cells) const;
  void free_line(const InkedLine& line, Columns& cells) const;
  double light(const SphereView& view, const Eigen::Vector3d& point) const;
  void draw_rows(const SphereView& view, const SphereInk& ink, int left, double top,
                 Image<float>& out) const;
  void add_picture(const SphereView& view, double weight, Image<double>& out) const;

  SpeckleSphere sphere_;
  SynthScene scene_;
  bool lit_;
  Eigen::Vector2d aside_;  // where the lamp is on the screen, and in space
  Eigen::Vector3d lamp_;
  int cells_per_pixel_, halo_;         // halo: pixels that the lens reaches
  std::vector<double> across_, down_;  // the filter over cells, and over rows of cells
  Image<double> backdrop_;
};

}  // namespace impactdic::sim::speckle
