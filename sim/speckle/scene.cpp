#include <impactdic/error.h>
#include <impactdic/synth.h>

#include "host/base/parallel/parallel_for.h"
#include "sim/speckle/noise.h"
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
  require(fixed_noise_sigma >= 0 && fixed_noise_sigma <= 255, "the fixed noise is out of range",
          "a standard deviation of 0 … 255 grey levels");
  require(shading >= 0 && shading <= 1, "the shading is out of range", "0 … 1");
  require(lamp_share >= 0 && lamp_share <= 1, "the lamp's share of the light is out of range",
          "0 … 1");
  require(std::abs(lamp_elevation_deg) <= 90, "the lamp's elevation is out of range",
          "-90 … 90 degrees");
  require(limb_darkening >= 0 && limb_darkening <= 1, "the limb darkening is out of range",
          "0 … 1");
  require(distance_radii == 0 || (distance_radii >= 1.5 && std::isfinite(distance_radii)),
          "the distance is out of range", "1.5 radii of the ball or more; 0: parallel rays");
  for (const double k : {distortion_k1, distortion_k2}) {
    require(std::abs(k) <= 0.3, "the distortion is out of range", "-0.3 … 0.3");
  }
  // The picture would run backwards beyond a fold, 1 + 3 k1 s + 5 k2 s^2 = 0.
  for (double s = 0; s <= 1.5; s += 0.05) {
    require(1 + s * (3 * distortion_k1 + 5 * s * distortion_k2) > 0.1,
            "the distortion folds the picture over", "less of it");
  }
  require(bits >= 8 && bits <= 16, "the bit depth is out of range", "8 … 16 bits");
  for (const double level : {white, ink, background, bar ? bar->level : 0.0}) {
    require(level >= 0 && level <= 255, "a grey level is out of range", "0 … 255");
  }
}

}  // namespace impactdic

namespace impactdic::sim::speckle {

namespace {

// `along`: the bar's direction, which takes longer to find than all the rest.
double coverage(const OccludingBar& bar, const Vec& along, double sigma_px, double x_px,
                double y_px) {
  const double off = std::abs((y_px - bar.y_px) * along.x - (x_px - bar.x_px) * along.y);
  const double half = bar.width_px / 2, reach = kEdgeReach * sigma_px;
  if (off > half + reach) return 0;
  if (off < half - reach) return 1;
  return blurred_edge(half - off, sigma_px) - blurred_edge(-half - off, sigma_px);
}

}  // namespace

double bar_coverage(const SynthScene& scene, double x_px, double y_px) {
  if (!scene.bar) return 0;
  return coverage(*scene.bar, direction(scene.bar->angle_deg), scene.psf_sigma_px, x_px, y_px);
}

Image<double> make_backdrop(const SynthScene& scene, const Quadrature& pixel) {
  Image<double> out(scene.width, scene.height, scene.background);
  if (!scene.bar) return out;
  const Vec along = direction(scene.bar->angle_deg);
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      double covered = 0;
      for (std::size_t j = 0; j < pixel.node.size(); ++j) {
        for (std::size_t i = 0; i < pixel.node.size(); ++i) {
          covered +=
              pixel.weight[j] * pixel.weight[i] *
              coverage(*scene.bar, along, scene.psf_sigma_px, x + pixel.node[i], y + pixel.node[j]);
        }
      }
      out(x, y) += covered * (scene.bar->level - scene.background);
    }
  }
  return out;
}

void FrameRenderer::render(const BallPose& pose, std::int64_t frame_index, Frame& out) const {
  render(ShutterPath{pose, pose, pose}, frame_index, out);
}

void develop(Image<double>& grey, const SynthScene& scene, std::int64_t frame_index, Frame& out) {
  out.reset(scene.width, scene.height, scene.bits);
  const double top = out.full_scale();
  parallel_for(static_cast<std::size_t>(scene.height), [&](std::size_t index) {
    const int y = static_cast<int>(index);
    double* row = grey.row(y);
    const auto width = static_cast<std::size_t>(scene.width);
    if (scene.noise_sigma > 0) {
      add_row_noise({row, width}, scene.noise_sigma, scene.noise_seed, frame_index, y);
    }
    if (scene.fixed_noise_sigma > 0) {
      constexpr std::int64_t kNoFrame = -1;
      add_row_noise({row, width}, scene.fixed_noise_sigma, scene.noise_seed, kNoFrame, y);
    }
    for (int x = 0; x < scene.width; ++x) {
      const double level = std::clamp(std::floor(row[x] * (top / 255) + 0.5), 0.0, top);
      if (out.type == PixelType::kU8) {
        out.u8(x, y) = static_cast<std::uint8_t>(level);
      } else {
        out.u16(x, y) = static_cast<std::uint16_t>(level);
      }
    }
  });
}

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
