// follow.cl against host/circle, which is its reference.
#include "host/circle/device/rim_follower.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "sim/speckle/render.h"
#include "tests/support/engine.h"

namespace impactdic {
namespace {

using testing::shared_engine;

constexpr int kFrames = 6;
constexpr int kLeft = 3, kTop = 5;  // of the part of a frame that the device has

struct Shot {
  std::vector<Frame> frames;
  std::vector<BallPose> poses;
};

Shot film(const std::string& pattern, double radius_px, SynthScene scene) {
  Shot shot;
  scene.width = scene.height = static_cast<int>(2 * radius_px) + 80;
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball(pattern, 7, radius_px), scene);
  for (int k = 0; k < kFrames; ++k) {
    const double middle = 0.5 * scene.width;
    const BallPose pose{middle + 0.13 + 0.618 * k, middle + 0.41 - 0.382 * k, 17.0 * k};
    shot.poses.push_back(pose);
    renderer.render(pose, k, shot.frames.emplace_back());
  }
  return shot;
}

circle::CirclePrior near(const BallPose& pose, double radius_px) {
  circle::CirclePrior prior;
  prior.predicted = {pose.cx_px + 0.021, pose.cy_px - 0.017, radius_px + 0.01};
  prior.centre_sd_px = 0.05;
  prior.rim_sd_px = 0.3;
  prior.learn = false;
  return prior;
}

// What both have of a shot's frames, from the rim model of the first one.
struct Both {
  std::vector<circle::CircleFit> host;
  std::vector<std::optional<circle::CircleFit>> device;
};

Both follow(const Shot& shot, double radius_px, const circle::CircleOptions& options,
            circle::CirclePrior known = {}) {
  Both both;
  circle::CirclePrior first = near(shot.poses[0], radius_px);
  first.centre_sd_px = 0.3;
  first.learn = true;
  const circle::CircleFit learnt = circle::measure_circle(shot.frames[0], first, options);
  if (!learnt.rim_model) return both;  // inked all around: there is none to follow
  dic::DeviceFrames frames(shared_engine(), kFrames);
  std::vector<dic::FramePart> parts;
  std::vector<circle::RimToFollow> rims;
  for (int k = 0; k < kFrames; ++k) {
    const auto& frame = shot.frames[static_cast<std::size_t>(k)];
    parts.push_back({&frame, kLeft, kTop});
    circle::CirclePrior prior = near(shot.poses[static_cast<std::size_t>(k)], radius_px);
    prior.rim_model = learnt.rim_model;
    prior.rim_fraction = learnt.rim_fraction;
    prior.bright = learnt.bright;
    prior.radius_px = known.radius_px;
    prior.radius_sd_px = known.radius_sd_px;
    prior.compression_axis_rad = known.compression_axis_rad;
    rims.push_back({&frame, k, kLeft, kTop, prior});
    both.host.push_back(circle::measure_circle(frame, prior, options));
  }
  frames.set(0, parts, shot.frames[0].width() - 8, shot.frames[0].height() - 8);
  circle::RimFollower follower(shared_engine(), options);
  both.device = follower.follow(frames, rims);
  return both;
}

// Frames that the device has told, and those of them of which it has kept another line.
struct Told {
  int frames = 0, by_other_lines = 0;
  void operator+=(const Told& more) {
    frames += more.frames, by_other_lines += more.by_other_lines;
  }
};

// Sums in another order, exponentials that are exact: hundredths of a deviation. A line that is
// clear to the one alone moves it by more.
Told expect_alike(const Both& both, const std::string& what) {
  Told told;
  for (std::size_t k = 0; k < both.device.size(); ++k) {
    SCOPED_TRACE(what + ", frame " + std::to_string(k));
    const auto& host = both.host[k];
    const auto& device = both.device[k];
    if (!device) continue;
    ++told.frames;
    const bool other_lines = std::abs(device->cx_sd_px - host.cx_sd_px) > 0.02 * host.cx_sd_px;
    told.by_other_lines += other_lines;
    const double off = other_lines ? 0.3 : 0.02, by = other_lines ? 0.1 : 0.02;
    EXPECT_EQ(device->status, host.status);
    EXPECT_EQ(device->ellipse, host.ellipse);
    EXPECT_NEAR(device->circle.cx_px, host.circle.cx_px, off * host.cx_sd_px);
    EXPECT_NEAR(device->circle.cy_px, host.circle.cy_px, off * host.cy_sd_px);
    EXPECT_NEAR(device->circle.r_px, host.circle.r_px, off * host.r_sd_px);
    EXPECT_NEAR(device->cx_sd_px, host.cx_sd_px, by * host.cx_sd_px);
    EXPECT_NEAR(device->cy_sd_px, host.cy_sd_px, by * host.cy_sd_px);
    EXPECT_NEAR(device->r_sd_px, host.r_sd_px, by * host.r_sd_px);
    EXPECT_NEAR(device->own_r_px, host.own_r_px, off * host.own_r_sd_px);
    EXPECT_NEAR(device->own_r_sd_px, host.own_r_sd_px, by * host.own_r_sd_px);
    EXPECT_NEAR(device->circle.free_px, host.circle.free_px, 1e-3);
    EXPECT_NEAR(device->rim_fraction, host.rim_fraction, 0.005);
    EXPECT_NEAR(device->residual_px, host.residual_px, by * host.residual_px);
    EXPECT_EQ(device->rim_model, host.rim_model);
  }
  return told;
}

// Of one frame in fifty.
void expect_few_others(const Told& told) { EXPECT_LE(50 * told.by_other_lines, told.frames); }

SynthScene usual_scene() {
  SynthScene scene;
  scene.noise_sigma = 2;
  return scene;
}

std::string name(const char* pattern, double radius_px) {
  return std::string(pattern) + ", " + std::to_string(radius_px) + " px";
}

TEST(RimFollower, FollowsEveryPatternAsTheHostDoes) {
  Told told;
  int asked = 0;
  for (const char* pattern : {"a1", "a2", "b1", "b3", "c2", "c3", "d1", "d3", "e1", "e2", "f1"}) {
    for (const double radius_px : {115.0, 47.0}) {
      const Both both = follow(film(pattern, radius_px, usual_scene()), radius_px, {});
      asked += static_cast<int>(both.device.size());
      told += expect_alike(both, name(pattern, radius_px));
    }
  }
  EXPECT_GE(asked, 20 * kFrames);
  EXPECT_GE(told.frames, asked - 2);
  expect_few_others(told);
}

// Of 12 bits, lit from one side, dark, behind a bar, also one as bright as the background; and what
// is known of its radius and of its axis.
TEST(RimFollower, FollowsInOtherLightAsTheHostDoes) {
  SynthScene deep = usual_scene();
  deep.bits = 12;
  SynthScene lit = usual_scene();
  lit.background = 90;
  lit.shading = 0.3;
  SynthScene dark = usual_scene();
  dark.white = 40, dark.ink = 110, dark.background = 200;
  SynthScene behind = usual_scene();
  behind.bar = OccludingBar{.x_px = 100, .y_px = 128, .angle_deg = 10, .width_px = 14};
  SynthScene unseen = behind;
  unseen.bar->level = unseen.background;
  circle::CirclePrior known;
  known.radius_px = 60.02;
  known.radius_sd_px = 0.01;
  known.compression_axis_rad = 0.4;
  Told told;
  for (const SynthScene& scene : {deep, lit, dark, behind, unseen}) {
    for (const char* pattern : {"a3", "c2", "d2"}) {
      const Shot shot = film(pattern, 60, scene);
      told += expect_alike(follow(shot, 60, {}), name(pattern, 60));
      told += expect_alike(follow(shot, 60, {}, known), name(pattern, 60) + ", known");
      circle::CircleOptions round;
      round.allow_ellipse = false;
      told += expect_alike(follow(shot, 60, round), name(pattern, 60) + ", round");
    }
  }
  EXPECT_GE(told.frames, 200);
  expect_few_others(told);
}

// What is not there to follow is left to the host.
TEST(RimFollower, LeavesWhatItCannotFollow) {
  const Shot shot = film("c2", 60, usual_scene());
  const circle::CirclePrior first = [&] {
    circle::CirclePrior prior = near(shot.poses[0], 60);
    prior.centre_sd_px = 0.3;
    prior.learn = true;
    return prior;
  }();
  const circle::CircleFit learnt = circle::measure_circle(shot.frames[0], first, {});
  ASSERT_NE(learnt.rim_model, nullptr);
  circle::CirclePrior prior = near(shot.poses[0], 60);
  prior.rim_model = learnt.rim_model;
  prior.bright = learnt.bright;
  dic::DeviceFrames frames(shared_engine(), 1);
  frames.set(0, shot.frames[0]);
  circle::RimFollower follower(shared_engine(), {});
  const auto told = [&](const circle::CirclePrior& of) {
    const circle::RimToFollow rim{&shot.frames[0], 0, 0, 0, of};
    return follower.follow(frames, std::span(&rim, 1))[0].has_value();
  };
  EXPECT_TRUE(told(prior));
  circle::CirclePrior off = prior;
  off.predicted.cx_px += 1.5;  // no rim where it is expected
  EXPECT_FALSE(told(off));
  circle::CirclePrior outside = prior;
  outside.predicted.cx_px = 50;  // partly outside of the picture
  EXPECT_FALSE(told(outside));
  circle::CirclePrior vague = prior;
  vague.centre_sd_px = 0.3;
  EXPECT_FALSE(told(vague));
  circle::CirclePrior dark = prior;
  dark.bright = !*prior.bright;
  EXPECT_FALSE(told(dark));
}

}  // namespace
}  // namespace impactdic
