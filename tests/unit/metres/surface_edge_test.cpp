// The surface's edge in pictures of a ball that comes down to it and flies off.
#include "host/run/metres/surface_edge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/run/metres/contradictions.h"

namespace impactdic::testing {
namespace {

constexpr int kWidth = 400, kHeight = 300;
constexpr double kRadius = 30;

// A wall behind, a surface of this inclination that the ball touches, and the ball at some places.
struct Scene {
  double angle_deg = 12;
  double contrast = 60;
  double gap_px = 0;  // between the circle at the touch and the edge
  double touch_x = 205, touch_y = 160;

  std::vector<Frame> frames;
  std::vector<TrackRow> rows;

  // Speed before and after along the picture's axes, y up, px a frame.
  void film(int count, double vx, double vy_before, double vy_after) {
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0, 2);
    const double angle = angle_deg * kRadPerDeg;
    for (int k = 0; k < count; ++k) {
      const double since = k - count / 2;
      TrackRow row;
      row.frame = k;
      row.circle_ok = true;
      row.r_px = kRadius;
      row.cx_px = touch_x + vx * since;
      row.cy_px = touch_y - (since < 0 ? vy_before : vy_after) * since;
      Frame frame;
      frame.reset(kWidth, kHeight, 8);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          // Height over the surface's edge, y up.
          const double over =
              -(x - touch_x) * std::sin(angle) - (y - touch_y) * std::cos(angle) + kRadius + gap_px;
          double grey = 120 - contrast * std::clamp(0.5 - over, 0.0, 1.0);
          const double off = std::hypot(x - row.cx_px, y - row.cy_px) - kRadius;
          grey += (220 - grey) * std::clamp(0.5 - off, 0.0, 1.0);
          frame.u8(x, y) =
              static_cast<std::uint8_t>(std::lround(std::clamp(grey + noise(random), 0.0, 255.0)));
        }
      }
      frames.push_back(std::move(frame));
      rows.push_back(row);
    }
  }
};

class MemoryFrames : public FrameSource {
 public:
  explicit MemoryFrames(const std::vector<Frame>& frames) : frames_(frames) {
    info_.width = kWidth, info_.height = kHeight;
    info_.frame_count = static_cast<std::int64_t>(frames.size());
  }
  const ClipInfo& info() const override { return info_; }
  void read(std::int64_t index, Frame& frame) override {
    frame = frames_.at(static_cast<std::size_t>(index));
  }

 private:
  const std::vector<Frame>& frames_;
  ClipInfo info_;
};

ImpactAnalysis analysis_of(const Scene& scene, double vx, double vy_before, double vy_after) {
  ImpactAnalysis analysis;
  analysis.status = ImpactStatus::kFound;
  const std::size_t count = scene.rows.size();
  analysis.before.last = count / 2, analysis.after.last = count - 1;
  analysis.before.vx.value = vx, analysis.before.vy.value = vy_before;
  analysis.after.vx.value = 0.8 * vx, analysis.after.vy.value = vy_after;
  analysis.turn.value = static_cast<double>(count) / 2;
  analysis.radius_px.value = kRadius;
  return analysis;
}

std::optional<Measured> found_in(Scene scene, int count = 24) {
  scene.film(count, 2.5, -6, 4.5);
  MemoryFrames clip(scene.frames);
  return run::surface_in_picture(clip, scene.rows, analysis_of(scene, 2.5, -6, 4.5));
}

TEST(SurfaceEdge, HasTheInclinationThatItWasDrawnWith) {
  for (const double angle : {-31.0, -4.0, 0.0, 12.3, 40.0}) {
    Scene scene;
    scene.angle_deg = angle;
    const auto edge = found_in(scene);
    ASSERT_TRUE(edge) << angle;
    EXPECT_NEAR(edge->value, angle, 4 * edge->sd) << angle;
    EXPECT_LT(edge->sd, 0.15) << angle;
  }
}

// Brighter than what is behind it; and a ball that covers the touch in every frame.
TEST(SurfaceEdge, IsSeenBesideABallThatNeverLeaves) {
  Scene scene;
  scene.contrast = -50;
  scene.film(24, 0.2, -0.8, 0.6);
  MemoryFrames clip(scene.frames);
  const auto edge = run::surface_in_picture(clip, scene.rows, analysis_of(scene, 0.2, -0.8, 0.6));
  ASSERT_TRUE(edge);
  EXPECT_NEAR(edge->value, scene.angle_deg, 4 * edge->sd);
}

TEST(SurfaceEdge, WhatTheBallDoesNotTouchIsNone) {
  Scene plain;
  plain.contrast = 0;
  EXPECT_FALSE(found_in(plain));
  Scene shelf;
  shelf.gap_px = 40;
  EXPECT_FALSE(found_in(shelf));
}

TEST(SurfaceEdge, ContradictsAWrongAngleUnlessTheSpinHoldsIt) {
  TrackRequest request;
  request.surface_angle_deg = 12;
  const Measured edge{12.2, 0.05};
  ImpactFigures figures;
  run::compare_with_edge(request, edge, figures);
  EXPECT_TRUE(figures.contradictions.empty());
  request.surface_angle_deg = -12;
  run::compare_with_edge(request, edge, figures);
  ASSERT_TRUE(run::contradicts(figures, "surface_angle"));
  EXPECT_TRUE(figures.is_doubtful(ImpactFigure::kRestitution));
  EXPECT_FALSE(figures.is_doubtful(ImpactFigure::kVxBefore));
  run::compare_with_edge(request, edge, figures);
  EXPECT_EQ(figures.contradictions.size(), 1u);
  ImpactFigures spun;  // path and spin show what was given: the edge is another thing's
  spun.surface_angle_deg = {-12.1, 0.4};
  run::compare_with_edge(request, edge, spun);
  EXPECT_TRUE(spun.contradictions.empty());
}

}  // namespace
}  // namespace impactdic::testing
