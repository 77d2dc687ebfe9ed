// Balls without a texture of their own: no spin out of a lamp's reflex.
#include <gtest/gtest.h>
#include <impactdic/advice.h>
#include <impactdic/track.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/support/cluttered_clip.h"

namespace impactdic::testing {
namespace {

ClutteredScene room(int frames) {
  ClutteredScene scene;
  scene.width = 260, scene.height = 190, scene.frames = frames;
  return scene;
}

// A steel ball: a lamp's reflex stays at its place of the disc, however the ball turns.
ClutteredScene steel() {
  ClutteredScene scene = room(16);
  scene.dots = {{-11, -14, 5, 250}};
  scene.ball = [](int k) { return Disc{60 + 8.3 * k, 80 + 1.7 * k, 34, 95}; };
  return scene;
}

TEST(Clutter, AReflexTellsNoSpin) {
  const ClutteredScene scene = steel();
  TrackRequest request;
  request.clip.source = std::make_shared<ClutteredClip>(scene);
  request.clip.fps = 500;
  Session session;
  const TrackResult result = impactdic::track(request, session);
  EXPECT_TRUE(result.advice.reflex_alone);
  EXPECT_TRUE(std::any_of(result.warnings.begin(), result.warnings.end(), [](const auto& warning) {
    return warning.find("a lamp's reflex") != std::string::npos;
  }));
  ASSERT_EQ(result.rows.size(), 16u);
  for (const TrackRow& row : result.rows) {
    const Disc truth = scene.ball(static_cast<int>(row.frame)).value();
    ASSERT_TRUE(row.circle_ok) << row.frame;
    EXPECT_LT(std::hypot(row.cx_px - truth.x_px, row.cy_px - truth.y_px), 0.1) << row.frame;
    EXPECT_FALSE(row.motion_ok) << row.frame;
    EXPECT_TRUE(std::isnan(row.rot_deg)) << row.frame;
  }
  const ImpactMotion& flight = result.impact_si.flight;
  ASSERT_TRUE(flight.known);
  EXPECT_NEAR(flight.vx.value, 8.3, 0.02);
  EXPECT_TRUE(std::isnan(flight.spin.value));
}

// A mark that turns with its ball, and speckles on a ball that does not turn, are texture.
TEST(Clutter, AMarkThatTurnsAndSpecklesAreNoReflex) {
  const auto reflex_alone = [](const ClutteredScene& scene) {
    InspectRequest request;
    request.clip.source = std::make_shared<ClutteredClip>(scene);
    const Inspection seen = inspect(request);
    EXPECT_TRUE(seen.advice.ball);
    return seen.advice.reflex_alone;
  };
  EXPECT_TRUE(reflex_alone(steel()));
  ClutteredScene turns = steel();
  turns.turn_deg = 3;
  EXPECT_FALSE(reflex_alone(turns));
  ClutteredScene speckled = steel();
  speckled.dots = {{-11, -14, 5, 250}, {12, 4, 3, 70}, {-4, 15, 2.5, 70}, {5, -16, 3, 70}};
  EXPECT_FALSE(reflex_alone(speckled));
}

}  // namespace
}  // namespace impactdic::testing
