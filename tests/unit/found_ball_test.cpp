// The ball among what else is round: screws that never move, an arm, a second ball.
#include <gtest/gtest.h>
#include <impactdic/advice.h>
#include <impactdic/error.h>
#include <impactdic/track.h>

#include <algorithm>
#include <memory>

#include "host/circle/scout_ball.h"
#include "host/pipeline/track_clip.h"
#include "tests/support/cluttered_clip.h"

namespace impactdic::testing {
namespace {

struct Outcome {
  int in_view = 0;   // frames that show the ball with all of its rim
  int found = 0;     // of these, within a pixel
  int wrong = 0;     // rows with a circle that is not the ball
  std::string rows;  // these
};

Outcome follow(const ClutteredScene& scene) {
  ClutteredClip clip(scene);
  pipeline::TrackOptions options;
  options.frames = {0, clip.info().frame_count, 1};
  options.roi = {0, 0, clip.info().width, clip.info().height};
  options.with_field = false;
  Outcome outcome;
  const auto judge = [&](const pipeline::TrackedFrame& frame) {
    const TrackRow& row = frame.row;
    const auto truth = scene.ball(static_cast<int>(row.frame));
    const bool whole = truth && truth->x_px > truth->r_px && truth->y_px > truth->r_px &&
                       truth->x_px < scene.width - 1 - truth->r_px &&
                       truth->y_px < scene.height - 1 - truth->r_px;
    outcome.in_view += whole;
    if (!row.circle_ok) return;
    // A pixel is much, but what is asked here is which thing was measured.
    const bool right = truth && std::hypot(row.cx_px - truth->x_px, row.cy_px - truth->y_px) < 1;
    outcome.found += whole && right;
    outcome.wrong += !right;
    if (right) return;
    outcome.rows += "frame " + std::to_string(row.frame) + ": " + std::to_string(row.cx_px) + ", " +
                    std::to_string(row.cy_px) + ", r " + std::to_string(row.r_px) + "\n";
  };
  pipeline::track_clip(
      clip, {}, options, [](std::span<const Window>, double) {}, judge,
      [](std::int64_t, std::int64_t) {});
  return outcome;
}

const std::vector<Disc> kDots = {{-9, -6, 4, 40}, {7, -8, 3, 40}, {2, 9, 5, 40}, {-4, 3, 2, 40}};

// A bench: screws of about the ball's size, brighter and larger than it; the ball falls through the
// picture in a third of the frames.
ClutteredScene bench() {
  ClutteredScene scene;
  scene.screws = {{60, 60, 24, 230}, {250, 180, 20, 20}, {255, 60, 26, 210}};
  scene.dots = kDots;
  scene.turn_deg = 3;
  scene.ball = [](int k) -> std::optional<Disc> {
    if (k < 14 || k > 30) return std::nullopt;
    return Disc{150 + 0.7 * k, -40.0 + 17.3 * (k - 13), 22, 200};
  };
  return scene;
}

TEST(FoundBall, ScrewsThatNeverMoveAreNotTheBall) {
  const Outcome outcome = follow(bench());
  EXPECT_GE(outcome.in_view, 10);
  EXPECT_EQ(outcome.found, outcome.in_view);
  EXPECT_EQ(outcome.wrong, 0) << outcome.rows;
}

// A dark ball over grain, and an arm that takes it out of the picture.
TEST(FoundBall, AnArmIsNotTheBall) {
  ClutteredScene scene;
  scene.frames = 34;
  scene.ground = 150;
  scene.grain = 25;
  scene.screws = {{300, 20, 12, 60}};
  scene.ball = [](int k) -> std::optional<Disc> {
    if (k > 24) return std::nullopt;
    return Disc{40 + 6.4 * k, 60 + 0.22 * k * k, 18, 35};
  };
  scene.arm = [](int k) -> std::optional<Limb> {
    if (k < 26) return std::nullopt;
    const double tip = 30 + 20.0 * (k - 25);
    return Limb{330, 40, 330 - std::min(tip, 200.0), 40 + 0.4 * tip, 12, 70};
  };
  const Outcome outcome = follow(scene);
  EXPECT_GE(outcome.in_view, 24);
  EXPECT_GE(outcome.found, outcome.in_view - 1);
  EXPECT_EQ(outcome.wrong, 0) << outcome.rows;
}

// A board of holes: more circles than are tried, all plainer than the ball.
TEST(FoundBall, AmongManyHolesWhatMovesIsFound) {
  ClutteredScene scene;
  scene.width = 200;
  scene.height = 160;
  scene.frames = 24;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 4; ++j) scene.screws.push_back({20.0 + 40 * i, 20.0 + 40 * j, 13, 20});
  }
  scene.ground = 190;
  scene.ball = [](int k) -> std::optional<Disc> {
    return Disc{-30 + 11.3 * k, 80 + 20 * std::sin(0.2 * k), 21, 110};
  };
  const Outcome outcome = follow(scene);
  EXPECT_GE(outcome.in_view, 12);
  EXPECT_GE(outcome.found, outcome.in_view * 9 / 10);
  EXPECT_EQ(outcome.wrong, 0) << outcome.rows;
}

// Where nothing moves at all, the shape alone tells.
TEST(FoundBall, AStillClipIsMeasuredByShape) {
  ClutteredScene scene;
  scene.ball = [](int) { return Disc{150, 110, 40, 220}; };
  const Outcome outcome = follow(scene);
  EXPECT_EQ(outcome.found, scene.frames);
}

// A ball that rests, and is hit when more than half of the clip is over.
TEST(FoundBall, ABallThatRestsBeforeItIsHitIsTheBall) {
  ClutteredScene scene = bench();
  scene.ball = [](int k) { return Disc{100 + 9.7 * std::max(0, k - 28), 120, 22, 200}; };
  const Outcome outcome = follow(scene);
  EXPECT_GE(outcome.found, outcome.in_view - 1);
  EXPECT_EQ(outcome.wrong, 0) << outcome.rows;
}

// Two balls at once: the scouts name both.
TEST(FoundBall, ASecondBallIsNamed) {
  ClutteredScene scene = bench();
  scene.frames = 24;
  scene.dots = {};
  scene.screws = {{60, 40, 24, 230}};
  scene.ball = [](int k) { return Disc{40 + 9.1 * k, 120 + 1.3 * k, 24, 210}; };
  const auto scout = [](const ClutteredScene& s) {
    ClutteredClip clip(s);
    const ClipInfo& info = clip.info();
    return circle::scout_ball(clip, {0, info.frame_count, 1}, {0, 0, info.width, info.height}, {});
  };
  const circle::Scouted one = scout(scene);
  ASSERT_TRUE(one.radius_px());
  EXPECT_NEAR(*one.radius_px(), 24, 0.3);
  EXPECT_EQ(one.second_ball(), nullptr);
  scene.other = [](int k) { return Disc{280 - 8.3 * k, 215 - 1.1 * k, 17, 220}; };
  const circle::Scouted two = scout(scene);
  ASSERT_NE(two.second_ball(), nullptr);
  EXPECT_NEAR(two.second_ball()->radius_px, 17, 0.3);
  EXPECT_GT(two.second_ball()->moved_px, 50);

  // And the run warns of it.
  TrackRequest request;
  request.clip.source = std::make_shared<ClutteredClip>(scene);
  request.with_field = false;
  Session session;
  const TrackResult result = impactdic::track(request, session);
  EXPECT_EQ(std::count_if(result.warnings.begin(), result.warnings.end(),
                          [](const std::string& warning) {
                            return warning.starts_with("a second ball is seen, of radius 17.");
                          }),
            1);
  for (const TrackRow& row : result.rows) {
    if (!row.circle_ok) continue;
    EXPECT_NEAR(row.r_px, 24, 0.5) << row.frame;
  }
}

// Two balls that cross each other's way; the person says which one is measured.
TEST(FoundBall, TheBallThatWasAskedForIsMeasured) {
  ClutteredScene scene = bench();
  scene.frames = 24;
  scene.dots = {};
  scene.screws = {{60, 40, 24, 230}};
  scene.ball = [](int k) { return Disc{40 + 9.1 * k, 120 + 1.3 * k, 20, 210}; };
  scene.other = [](int k) { return Disc{280 - 8.3 * k, 205 - 1.1 * k, 18, 220}; };
  InspectRequest look;
  look.clip.source = std::make_shared<ClutteredClip>(scene);
  look.candidates = true;
  const Inspection seen = inspect(look);
  ASSERT_EQ(seen.candidates.size(), 2u);
  Session session;
  for (int rank = 1; rank <= 2; ++rank) {
    const BallSeen& asked = seen.candidates[static_cast<std::size_t>(rank - 1)];
    const bool is_other = asked.radius_px < 19;
    const auto truth = [&](std::int64_t frame) {
      return (is_other ? scene.other : scene.ball)(static_cast<int>(frame)).value();
    };
    EXPECT_NEAR(asked.place.cx_px, truth(asked.frame).x_px, 1) << rank;
    EXPECT_GT(asked.moved_px, 100) << rank;
    TrackRequest request;
    request.clip.source = look.clip.source;
    request.with_field = false;
    request.ball = rank;
    const TrackResult result = impactdic::track(request, session);
    int right = 0;
    for (const TrackRow& row : result.rows) {
      if (!row.circle_ok) continue;
      const Disc at = truth(row.frame);
      EXPECT_LT(std::hypot(row.cx_px - at.x_px, row.cy_px - at.y_px), 1)
          << rank << ' ' << row.frame;
      ++right;
    }
    EXPECT_GE(right, 20) << rank;
  }
  TrackRequest third;
  third.clip.source = look.clip.source;
  third.with_field = false;
  third.ball = 3;
  EXPECT_THROW(impactdic::track(third, session), InvalidArgument);
  third.ball = -1;
  EXPECT_THROW(third.validate(), InvalidArgument);
}

}  // namespace
}  // namespace impactdic::testing
