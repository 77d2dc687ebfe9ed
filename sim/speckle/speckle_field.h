// A speckled surface known at every point: a sum of Gaussian blots, integrated over each pixel in
// closed form, so that shifted and turned pictures of it carry no interpolation error.
#pragma once

#include <impactdic/image.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace impactdic::sim::speckle {

struct SpeckleField {
  struct Blot {
    double x, y, sigma, height;
  };
  std::vector<Blot> blots;

  // `count` blots over 0 … extent, standard deviations about `sigma_px`, heights ±.
  SpeckleField(int count, double extent_px, double sigma_px, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(0, extent_px), spread(0.8, 1.25);
    std::normal_distribution<double> height(0, 1);
    for (int i = 0; i < count; ++i) {
      blots.push_back({place(random), place(random), sigma_px * spread(random), height(random)});
    }
  }

  // The surface moved by (dx, dy) and turned by `turn_rad` (counter-clockwise on screen) about
  // (cx, cy): `level` + `contrast` · Σ blots + noise, rounded to `bits` and clipped.
  Frame render(int width, int height, double dx, double dy, double turn_rad = 0, double cx = 0,
               double cy = 0, int bits = 8, double noise = 0, unsigned seed = 1) const {
    const double scale = ((1u << bits) - 1) / 255.0, level = 128, contrast = 60;
    std::vector<double> sum(static_cast<std::size_t>(width) * height, 0.0);
    const double c = std::cos(turn_rad), s = std::sin(turn_rad);
    for (const Blot& blot : blots) {
      const double x = cx + dx + (blot.x - cx) * c + (blot.y - cy) * s;
      const double y = cy + dy - (blot.x - cx) * s + (blot.y - cy) * c;
      add(sum, width, height, {x, y, blot.sigma, blot.height});
    }
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 1);
    Frame frame;
    frame.reset(width, height, bits);
    for (std::size_t i = 0; i < sum.size(); ++i) {
      const double grey = level + contrast * sum[i] + (noise > 0 ? noise * normal(random) : 0);
      const double stored = std::clamp(std::round(grey * scale), 0.0, frame.full_scale());
      if (bits <= 8) {
        frame.u8.data()[i] = static_cast<std::uint8_t>(stored);
      } else {
        frame.u16.data()[i] = static_cast<std::uint16_t>(stored);
      }
    }
    return frame;
  }

 private:
  static void add(std::vector<double>& sum, int width, int height, const Blot& blot) {
    const int reach = static_cast<int>(std::ceil(6 * blot.sigma)) + 1;
    const int x0 = std::max(0, static_cast<int>(blot.x) - reach);
    const int x1 = std::min(width - 1, static_cast<int>(blot.x) + reach);
    const int y0 = std::max(0, static_cast<int>(blot.y) - reach);
    const int y1 = std::min(height - 1, static_cast<int>(blot.y) + reach);
    const double k = 1 / (std::sqrt(2.0) * blot.sigma);
    // Mean of a Gaussian over the pixel from p − ½ to p + ½.
    const auto share = [&](double p) {
      return blot.sigma * std::sqrt(3.14159265358979323846 / 2) *
             (std::erf((p + 0.5) * k) - std::erf((p - 0.5) * k));
    };
    std::vector<double> across;
    for (int x = x0; x <= x1; ++x) across.push_back(share(x - blot.x));
    for (int y = y0; y <= y1; ++y) {
      const double down = blot.height * share(y - blot.y);
      for (int x = x0; x <= x1; ++x) {
        sum[static_cast<std::size_t>(y) * width + x] +=
            down * across[static_cast<std::size_t>(x - x0)];
      }
    }
  }
};

}  // namespace impactdic::sim::speckle
