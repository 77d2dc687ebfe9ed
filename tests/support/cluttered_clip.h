// Clips as a laboratory shows them: a ball before screws, grain, an arm and another ball. Rendered
// with soft edges and noise when they are read.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "host/video/frame_source.h"

namespace impactdic::testing {

struct Disc {
  double x_px = 0, y_px = 0, r_px = 0, level = 0;
};

// From one end to the other, r_px thick.
struct Limb {
  double x0_px = 0, y0_px = 0, x1_px = 0, y1_px = 0, r_px = 0, level = 0;
};

struct ClutteredScene {
  int width = 320, height = 240, frames = 48;
  double ground = 120, grain = 0;  // level behind all, and of the grain along the rows
  double noise = 1.5;
  std::vector<Disc> screws;                            // that stand still
  std::vector<Disc> dots = {};                         // ink on the ball, about its centre
  double turn_deg = 0;                                 // of the ball a frame
  std::function<std::optional<Disc>(int)> ball;        // in frame k
  std::function<std::optional<Disc>(int)> other = {};  // another ball
  std::function<std::optional<Limb>(int)> arm = {};    // in front of all
};

class ClutteredClip : public FrameSource {
 public:
  explicit ClutteredClip(ClutteredScene scene) : scene_(std::move(scene)) {
    info_.format = "rendered";
    info_.width = scene_.width;
    info_.height = scene_.height;
    info_.frame_count = scene_.frames;
    still_.resize(scene_.width, scene_.height);
    for (int y = 0; y < scene_.height; ++y) {
      for (int x = 0; x < scene_.width; ++x) {
        double level = scene_.ground + scene_.grain * std::sin(0.35 * y + 2 * std::sin(0.02 * x)) *
                                           std::sin(0.11 * x + 0.9 * y);
        for (const Disc& screw : scene_.screws) paint(level, screw, x, y);
        still_(x, y) = level;
      }
    }
  }
  const ClipInfo& info() const override { return info_; }
  void read(std::int64_t index, Frame& frame) override {
    const int k = static_cast<int>(index);
    const auto ball = scene_.ball ? scene_.ball(k) : std::nullopt;
    const auto other = scene_.other ? scene_.other(k) : std::nullopt;
    const auto arm = scene_.arm ? scene_.arm(k) : std::nullopt;
    std::mt19937 random(static_cast<unsigned>(77 + k));
    std::normal_distribution<double> noise(0, scene_.noise);
    frame.reset(scene_.width, scene_.height, 8);
    for (int y = 0; y < scene_.height; ++y) {
      for (int x = 0; x < scene_.width; ++x) {
        double level = still_(x, y);
        if (other) paint(level, *other, x, y);
        if (ball) paint_ball(level, *ball, k, x, y);
        if (arm) paint(level, *arm, x, y);
        frame.u8(x, y) =
            static_cast<std::uint8_t>(std::clamp(std::lround(level + noise(random)), 0L, 255L));
      }
    }
  }

 private:
  // Blends over an edge of some 1.5 px; `inside` is the distance from it.
  static void blend(double& level, double over, double inside) {
    level += (over - level) * std::clamp(0.5 + inside / 1.5, 0.0, 1.0);
  }
  static void paint(double& level, const Disc& disc, double x, double y) {
    if (std::abs(x - disc.x_px) > disc.r_px + 2) return;
    blend(level, disc.level, disc.r_px - std::hypot(x - disc.x_px, y - disc.y_px));
  }
  static void paint(double& level, const Limb& limb, double x, double y) {
    const double dx = limb.x1_px - limb.x0_px, dy = limb.y1_px - limb.y0_px;
    const double along = ((x - limb.x0_px) * dx + (y - limb.y0_px) * dy) / (dx * dx + dy * dy);
    const double t = std::clamp(along, 0.0, 1.0);
    blend(level, limb.level,
          limb.r_px - std::hypot(x - limb.x0_px - t * dx, y - limb.y0_px - t * dy));
  }
  void paint_ball(double& level, const Disc& ball, int k, double x, double y) const {
    const double inside = ball.r_px - std::hypot(x - ball.x_px, y - ball.y_px);
    if (inside < -2) return;
    double paint_level = ball.level;
    const double angle = scene_.turn_deg * k * std::acos(-1.0) / 180;
    const double c = std::cos(angle), s = std::sin(angle);
    for (const Disc& dot : scene_.dots) {
      const Disc turned{ball.x_px + c * dot.x_px + s * dot.y_px,
                        ball.y_px - s * dot.x_px + c * dot.y_px, dot.r_px, dot.level};
      paint(paint_level, turned, x, y);
    }
    blend(level, paint_level, inside);
  }

  ClutteredScene scene_;
  Image<double> still_;  // what does not move
  ClipInfo info_;
};

}  // namespace impactdic::testing
