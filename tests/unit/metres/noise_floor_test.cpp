// Still scenes: found where a clip begins with one, and how their windows scatter.
#include "host/run/metres/noise_floor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace impactdic::testing {
namespace {

constexpr std::size_t kWindows = 200;
constexpr double kNoise_px = 0.006;

struct Scene {
  ReferenceFrame reference = ReferenceFrame::kFirst;
  // Displacement of window i in frame k since frame 0, px.
  std::function<double(int k, std::size_t i)> u = [](int, std::size_t) { return 0.0; };
};

// Frames 0 to `last`, each with its own noise; what `correlate` would measure of them.
std::optional<NoiseFloor> floor_of(const Scene& scene, int last, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, kNoise_px);
  std::vector<double> before_u(kWindows), before_v(kWindows);
  const auto draw = [&](int k, std::vector<double>& u, std::vector<double>& v) {
    for (std::size_t i = 0; i < kWindows; ++i) {
      u[i] = scene.u(k, i) + noise(random);
      v[i] = noise(random);
    }
  };
  draw(0, before_u, before_v);
  run::StillFrames still(scene.reference, 100);
  MotionRow row;
  row.is_reference = true;
  still.add(row, {});
  std::vector<double> u(kWindows), v(kWindows);
  for (int k = 1; k <= last; ++k) {
    draw(k, u, v);
    std::vector<WindowMotion> field(kWindows);
    row = {};
    row.frame = k;
    row.motion_ok = true;
    row.dx_px = row.dy_px = row.rot_deg = 0;
    row.dx_sd_px = row.dy_sd_px = kNoise_px * std::sqrt(2.0 / kWindows);
    for (std::size_t i = 0; i < kWindows; ++i) {
      field[i].status = static_cast<std::int32_t>(WindowStatus::kOk);
      field[i].u = static_cast<float>(u[i] - before_u[i]);
      field[i].v = static_cast<float>(v[i] - before_v[i]);
      field[i].u_sd = field[i].v_sd = static_cast<float>(kNoise_px * std::sqrt(2.0));
      row.dx_px += field[i].u / static_cast<double>(kWindows);
      row.dy_px += field[i].v / static_cast<double>(kWindows);
    }
    still.add(row, field);
    if (scene.reference == ReferenceFrame::kPrevious) before_u = u, before_v = v;
  }
  return still.floor();
}

TEST(NoiseFloor, IsTheScatterOfAStillScene) {
  const auto floor = floor_of({}, 20);
  ASSERT_TRUE(floor);
  EXPECT_EQ(floor->frames, 20);
  EXPECT_EQ(floor->last_frame, 20);
  EXPECT_EQ(floor->windows, kWindows);
  // 4000 values, and 200 of the first frame: 5 %.
  EXPECT_NEAR(floor->u_temporal_sd, kNoise_px, 0.05 * kNoise_px);
  EXPECT_NEAR(floor->v_temporal_sd, kNoise_px, 0.05 * kNoise_px);
  EXPECT_NEAR(floor->u_spatial_sd, std::sqrt(2.0) * kNoise_px, 0.07 * kNoise_px);
  EXPECT_NEAR(floor->u_stated_sd, std::sqrt(2.0) * kNoise_px, 1e-6);
  EXPECT_NEAR(floor->u_mean, 0, 4 * kNoise_px / std::sqrt(1.0 * kWindows));
}

TEST(NoiseFloor, OfStepsHoldsTheNoiseOfBothFrames) {
  const auto floor =
      floor_of({ReferenceFrame::kPrevious, {[](int, std::size_t) { return 0.0; }}}, 20);
  ASSERT_TRUE(floor);
  EXPECT_EQ(floor->frames, 20);
  EXPECT_NEAR(floor->u_temporal_sd, std::sqrt(2.0) * kNoise_px, 0.07 * kNoise_px);
}

TEST(NoiseFloor, EndsWhereTheSceneMoves) {
  for (const auto reference : {ReferenceFrame::kFirst, ReferenceFrame::kPrevious}) {
    const auto jump =
        floor_of({reference, [](int k, std::size_t) { return k > 8 ? 0.05 * (k - 8) : 0.0; }}, 20);
    ASSERT_TRUE(jump);
    EXPECT_EQ(jump->last_frame, 8);
    // It stretches about its middle, which stays.
    const auto stretch = floor_of(
        {reference,
         [](int k, std::size_t i) {
           return k > 8 ? 0.03 * (k - 8) * (static_cast<double>(i) / kWindows - 0.5) * 2 : 0.0;
         }},
        20);
    ASSERT_TRUE(stretch);
    EXPECT_LE(stretch->last_frame, 9);
  }
}

TEST(NoiseFloor, IsNotStatedOfWhatMoves) {
  EXPECT_FALSE(floor_of({ReferenceFrame::kFirst, [](int k, std::size_t) { return 0.5 * k; }}, 20));
  EXPECT_FALSE(floor_of({}, 2));
  // By too little a frame for any one to show it.
  for (const auto reference : {ReferenceFrame::kFirst, ReferenceFrame::kPrevious}) {
    EXPECT_FALSE(floor_of({reference, [](int k, std::size_t) { return 0.002 * k; }}, 30));
    EXPECT_FALSE(floor_of({reference,
                           [](int k, std::size_t i) {
                             return 0.003 * k * (static_cast<double>(i) / kWindows - 0.5);
                           }},
                          30));
  }
}

TEST(NoiseFloor, SteadyScenesAreNotSaidToCreep) {
  int stated = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) stated += floor_of({}, 5, seed).has_value();
  EXPECT_EQ(stated, 100);
}

}  // namespace
}  // namespace impactdic::testing
