// Whole runs without options on rooms as people film them: a ball bounces before shelves and grain,
// led by a hand, beside things that are as round as it. The ball alone is found, and its bounces
// are listed.
#include <gtest/gtest.h>
#include <impactdic/track.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/cluttered_clip.h"

namespace impactdic::testing {
namespace {

const std::vector<Disc> kSpeckles = {{-13, -9, 4, 60}, {10, -12, 3.5, 60}, {3, 13, 5, 60},
                                     {-6, 4, 3, 60},   {14, 3, 3, 60},     {-2, -17, 3, 60}};

// A ball that falls from rest and bounces on a floor.
struct Bouncing {
  double x_px = 0, vx_px = 0, top_px = 0, floor_px = 0, r_px = 0, level = 0;
  double gravity = 0, restitution = 0;
  int let_go = 0;                     // frame
  std::vector<double> instants = {};  // of the bounces

  // Its centre in frame `k`, and the bounces up to there.
  Disc at(double k, std::vector<double>* bounces = nullptr) const {
    Disc ball{x_px + vx_px * std::max(0.0, k - let_go), top_px, r_px, level};
    const double lowest = floor_px - r_px;
    double since = std::max(0.0, k - let_go), begun = let_go;
    double y = top_px, up = 0;  // at `begun`
    for (;;) {
      const double lasts = (up + std::sqrt(up * up + 2 * gravity * (lowest - y))) / gravity;
      if (since < lasts) break;
      since -= lasts, begun += lasts;
      if (bounces != nullptr) bounces->push_back(begun);
      up = restitution * (gravity * lasts - up);
      y = lowest;
    }
    ball.y_px = y - up * since + gravity * since * since / 2;
    return ball;
  }
};

ClutteredScene room(const Bouncing& ball, int frames) {
  ClutteredScene scene;
  scene.width = 640, scene.height = 480, scene.frames = frames;
  scene.dots = kSpeckles;
  for (Disc& dot : scene.dots) {
    if (ball.level < 100) dot.level = 200;
  }
  scene.turn_deg = 2;
  scene.ball = [ball](int k) { return ball.at(k); };
  return scene;
}

// `hidden`: whether something may hide the ball in a frame.
void expect_bounces(const ClutteredScene& scene, const Bouncing& ball,
                    const std::function<bool(int)>& hidden) {
  TrackRequest request;
  request.clip.source = std::make_shared<ClutteredClip>(scene);
  request.clip.fps = 240;
  Session session;
  const TrackResult result = impactdic::track(request, session);
  ASSERT_EQ(result.rows.size(), static_cast<std::size_t>(scene.frames));
  int in_view = 0, found = 0;
  for (const TrackRow& row : result.rows) {
    const int k = static_cast<int>(row.frame);
    const Disc truth = ball.at(k);
    const bool shown = !hidden(k) && truth.x_px < scene.width - 1 - truth.r_px;
    in_view += shown;
    if (!row.circle_ok) continue;
    const double off = std::hypot(row.cx_px - truth.x_px, row.cy_px - truth.y_px);
    EXPECT_LT(off, 1) << "frame " << k << ": " << row.cx_px << ", " << row.cy_px << ", r "
                      << row.r_px;
    found += shown && off < 1;
  }
  EXPECT_GE(found, 0.97 * in_view);
  std::vector<double> bounces;
  ball.at(scene.frames - 1, &bounces);
  std::vector<const ImpactFigures*> listed = {&result.impact_si};
  for (const ImpactFigures& other : result.more_impacts_si) listed.push_back(&other);
  std::sort(listed.begin(), listed.end(), [](const auto* a, const auto* b) {
    return a->t_max_compression.frame < b->t_max_compression.frame;
  });
  std::string text;
  for (const ImpactFigures* impact : listed) {
    text += std::to_string(impact->t_max_compression.frame) + " ";
  }
  ASSERT_EQ(listed.size(), bounces.size()) << text;
  for (std::size_t i = 0; i < listed.size(); ++i) {
    ASSERT_TRUE(listed[i]->found()) << i;
    EXPECT_NEAR(listed[i]->t_max_compression.frame, bounces[i], 1) << i;
    const Measured& e = listed[i]->restitution;
    EXPECT_LT(std::abs(e.value - ball.restitution), 3 * e.sd) << i << ": " << e.value;
    EXPECT_LT(e.sd, 0.3) << i;  // as long as the gap in the flights the contact may last
  }
}

// A hand holds the ball, lets it fall and stays; wallpaper behind them.
TEST(ClutteredBounces, AHandThatLetsTheBallFall) {
  Bouncing ball{200, 0.9, 90, 440, 24, 215, 0.9, 0.75, 18};
  ClutteredScene scene = room(ball, 132);
  scene.ground = 110, scene.grain = 22;
  scene.arm = [ball](int k) -> std::optional<Limb> {
    // From above, the fingers about the ball's top; then it opens and goes back.
    const double away = 1.6 * std::max(0, k - ball.let_go);
    return Limb{80 - away, -20, 186 - away, 72 - 0.4 * away, 15, 165};
  };
  expect_bounces(scene, ball, [&](int k) { return k < ball.let_go + 8; });
}

// Round things that stand still, two of them of the ball's size and grey; a leg walks by behind.
TEST(ClutteredBounces, BesidePlatesOfItsSize) {
  Bouncing ball{90, 3.1, 70, 430, 22, 200, 1.1, 0.7, 0};
  ClutteredScene scene = room(ball, 100);
  scene.ground = 90, scene.grain = 12;
  scene.screws = {{420, 120, 22, 200},
                  {520, 250, 23, 195},
                  {300, 60, 30, 40},
                  {580, 80, 16, 230},
                  {60, 460, 14, 220}};
  expect_bounces(scene, ball, [](int) { return false; });
}

// A dark ball in noisy film, an arm that waves in front of it, another ball that lies on the floor.
TEST(ClutteredBounces, AnArmThatWavesBeforeIt) {
  Bouncing ball{150, 2.2, 60, 450, 26, 45, 1.0, 0.8, 4};
  ClutteredScene scene = room(ball, 134);
  scene.ground = 160, scene.grain = 15, scene.noise = 4;
  scene.screws = {{560, 424, 26, 60}, {30, 60, 20, 90}};
  scene.arm = [](int k) -> std::optional<Limb> {
    const double lift = 40 * std::sin(0.13 * k);
    return Limb{660, 120, 520, 150 - lift, 14, 110};
  };
  expect_bounces(scene, ball, [](int) { return false; });
}

}  // namespace
}  // namespace impactdic::testing
