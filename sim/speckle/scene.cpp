#include <impactdic/error.h>
#include <impactdic/synth.h>

#include "sim/speckle/render_parts.h"

namespace impactdic {

void SynthScene::validate() const {
  const auto require = [](bool good, const char* what, const char* hint) {
    if (!good) throw InvalidArgument(what, "scene", hint);
  };
  require(width >= 1 && height >= 1 && width <= 32768 && height <= 32768,
          "the picture's size is impossible", "1 … 32768 px a side");
  require(psf_sigma_px >= 0.3 && psf_sigma_px <= 50, "the lens blur is out of range",
          "a standard deviation of 0.3 … 50 px");
  require(noise_sigma >= 0 && noise_sigma <= 255, "the noise is out of range",
          "a standard deviation of 0 … 255 grey levels");
  require(shading >= 0 && shading <= 1, "the shading is out of range", "0 … 1");
  require(bits >= 8 && bits <= 16, "the bit depth is out of range", "8 … 16 bits");
  for (const double level : {white, ink, background, bar ? bar->level : 0.0}) {
    require(level >= 0 && level <= 255, "a grey level is out of range", "0 … 255");
  }
}

}  // namespace impactdic

namespace impactdic::sim::speckle {

OccludingBar bar_hiding(double fraction, const BallPose& pose, double radius_px, double angle_deg) {
  if (!(fraction >= 0 && fraction <= 1)) {
    throw InvalidArgument("the hidden share of the ball is out of range", "occlude", "0 … 1");
  }
  // A segment below the chord at height h (of the radius, downward) has the share
  // (acos h − h √(1 − h²)) / π, which falls with h.
  double low = -1, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double h = (low + high) / 2;
    const double share = (std::acos(h) - h * std::sqrt(1 - h * h)) / kPi;
    (share > fraction ? low : high) = h;
  }
  OccludingBar bar;
  bar.width_px = 2.5 * radius_px;
  bar.angle_deg = angle_deg;
  const Vec down = direction(angle_deg - 90);
  const double away = radius_px * (low + high) / 2 + bar.width_px / 2;
  bar.x_px = pose.cx_px + away * down.x;
  bar.y_px = pose.cy_px + away * down.y;
  return bar;
}

}  // namespace impactdic::sim::speckle
