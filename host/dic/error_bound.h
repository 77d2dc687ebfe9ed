// How exactly a picture lets motion be measured, whatever the estimator: the Cramér–Rao bound from
// its slopes and its noise.
#pragma once

#include <impactdic/advice.h>
#include <impactdic/image.h>

#include <vector>

namespace impactdic::dic {

// One standard deviation of a displacement between two pictures of equal noise; infinite where the
// slopes do not fix it.
struct WindowBound {
  double contrast = 0;  // rms of the grey levels about their mean, the noise's own share left out
  double u_sd_px = 0, v_sd_px = 0;
  // Of affine windows, the larger one of both as IC-GN expects it: above the bound, since it takes
  // the noise's slopes for the picture's, and interpolation errs (kernels/icgn/icgn.cl).
  double expected_sd_px = 0;
};

// A picture's slopes by the quintic B-spline through it, and their sums over squares of any size.
class PictureSlopes {
 public:
  // `noise`: standard deviation of the noise in `picture`, same grey levels, 0 for a rendered one;
  // its expected share is taken out of every sum. Slopes near the border see the picture mirrored.
  PictureSlopes(ImageView<const float> picture, double noise);

  int width() const { return width_; }
  int height() const { return height_; }

  // Square of `side` pixels from (x0, y0), which must lie in the picture, measured between two
  // pictures of noise `noise`: covariance 2 noise² (Σ g gᵀ)⁻¹.
  WindowBound window(int x0, int y0, int side, double noise) const;

  // The same for a window that may deform affinely, as IC-GN's do: J = (g_x, g_y) ⊗ (1, X, Y), X, Y
  // from the window's centre. A single edge does not fix these six.
  WindowBound affine_window(int x0, int y0, int side, double noise) const;

  // The whole disc about (cx, cy), as far as it is in the picture: 2 noise² (Σ J Jᵀ)⁻¹ with
  // J = (g_x, g_y, g_x Y − g_y X), X, Y from the centre.
  BallBound disc(double cx_px, double cy_px, double radius_px, double noise) const;

 private:
  // Sums over all pixels above and left of a pixel's corner; (height + 1, width + 1).
  struct Sums {
    double value, square, xx, xy, yy;
  };
  const Sums& sums(int x, int y) const {
    return sums_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1) +
                 static_cast<std::size_t>(x)];
  }

  int width_ = 0, height_ = 0;
  double noise_ = 0, slope_noise_ = 0;  // variances: of a pixel, of a slope
  double slope_gain_ = 0;               // the latter over the former
  Image<float> slope_x_, slope_y_;
  std::vector<Sums> sums_;
};

}  // namespace impactdic::dic
