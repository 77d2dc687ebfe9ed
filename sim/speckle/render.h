// Pictures of a speckled ball, computed from formulas at the ball's exact sub-pixel pose: no
// picture is ever resampled, so the motion between two frames is known to double precision.
//
// The model. Every speckle is a disc or a line of full ink, blurred by the lens (Gaussian, σ) in
// closed form to a coverage S_i(x). The ball shows white · ∏(1 − S_i) + ink · (1 − ∏(1 − S_i)),
// times the lamp's shading; the ball's own blurred disc covers the background; a static bar may
// cover both. Each pixel is the mean of that over its square (error ≤ 0.01 grey levels at any
// σ >= 0.3 px against finer quadrature, see tests/unit/render_test.cpp).
// A compressed ball's picture is the affine image of the round one under the same lens: the share
// of the lens's blur that the compression takes away along its axis is put back by Gauss–Hermite
// quadrature.
#pragma once

#include <impactdic/synth.h>

#include <cstdint>
#include <vector>

#include "sim/speckle/blur.h"
#include "sim/speckle/motion.h"
#include "sim/speckle/pattern.h"

namespace impactdic::sim::speckle {

// A bar that hides the share `fraction` (0 … 1) of the disc's area of a ball at this pose: all that
// lies beyond a chord, on the lower side, as a racket does. `angle_deg` is the chord's direction,
// counter-clockwise from image-right.
OccludingBar bar_hiding(double fraction, const BallPose& pose, double radius_px,
                        double angle_deg = 0);

// Makes the frames of a clip.
class FrameRenderer {
 public:
  virtual ~FrameRenderer() = default;
  // The picture without noise or rounding, grey levels of 255, (height, width).
  virtual Image<double> exact(const ShutterPath& path) const = 0;
  // The camera's frame: noise of (seed, frame_index), rounded and clipped at scene.bits.
  virtual void render(const ShutterPath& path, std::int64_t frame_index, Frame& out) const = 0;
  void render(const BallPose& pose, std::int64_t frame_index, Frame& out) const;
};

// Adds the camera's noise to a picture and makes it a frame of scene.bits.
void develop(Image<double>& grey, const SynthScene& scene, std::int64_t frame_index, Frame& out);

// Background and bar.
Image<double> make_backdrop(const SynthScene& scene, const Quadrature& pixel);
// Share of the light that the blurred bar takes away.
double bar_coverage(const SynthScene& scene, double x_px, double y_px);
// Samples a side of a pixel that resolve the product of several edges of this blur.
int samples_per_pixel(double sigma_px);

// Renders one ball in one scene. All tables are made in the constructor; rendering is const, may
// be called from several threads, and uses all of TBB's threads itself. The result does not depend
// on their number.
class BallRenderer : public FrameRenderer {
 public:
  // Throws InvalidArgument for an impossible scene.
  BallRenderer(SpeckleBall ball, const SynthScene& scene);

  // The picture without noise or rounding, grey levels of 255, (height, width).
  Image<double> exact(const BallPose& pose) const;
  Image<double> exact(const ShutterPath& path) const override;

  using FrameRenderer::render;
  void render(const ShutterPath& path, std::int64_t frame_index, Frame& out) const override;

  const SpeckleBall& ball() const { return ball_; }
  const SynthScene& scene() const { return scene_; }

 private:
  struct Placed;  // the ball at one instant, in screen axes
  struct Band;    // samples of some pixel rows

  std::vector<Placed> instants(const ShutterPath& path) const;
  Placed place(const BallPose& pose, double shift_px, double weight) const;
  void add_rows(const Placed& placed, int first, int last, Image<double>& out) const;
  void paint_discs(const Placed& placed, Band& band) const;
  void paint_lines(const Placed& placed, Band& band) const;
  void sum_pixels(const Placed& placed, const Band& band, Image<double>& out) const;

  SpeckleBall ball_;
  SynthScene scene_;
  BlurredDisc outline_;
  std::vector<BlurredDisc> inks_;  // one per disc
  int per_pixel_;                  // samples a side of a pixel
  Quadrature pixel_;               // a pixel's mean from those samples and its neighbours'
  Image<double> backdrop_;         // background and bar
};

}  // namespace impactdic::sim::speckle
