// A track whose circles the device follows is that whose circles the host does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "host/base/stage_times.h"
#include "tests/support/rendered_clip.h"
#include "tests/support/speckle_frames.h"

namespace impactdic::testing {
namespace {

struct Tracked {
  std::vector<TrackRow> rows;
  bool asked = false;  // a device for circles
};

Tracked track_with(FrameSource& clip, bool on_device) {
  StageTimes times;
  pipeline::TrackOptions options;
  options.estimator.estimator = Estimator::kBall;
  options.batch = 21;
  options.circles_on_device = on_device;
  options.times = &times;
  Tracked tracked{track(clip, options)};
  for (const StageTimes::Row& row : times.rows()) {
    tracked.asked = tracked.asked || (row.name == "circles on device" && row.busy_s > 0);
  }
  return tracked;
}

// Sums in another order: hundredths of a deviation, and more where a line is kept by the one and
// not by the other. Returns how many rows differ at all.
int expect_alike(const std::vector<TrackRow>& device, const std::vector<TrackRow>& host) {
  EXPECT_EQ(device.size(), host.size());
  int differ = 0, held = 0;
  double squares = 0;
  for (std::size_t k = 0; k < std::min(device.size(), host.size()); ++k) {
    SCOPED_TRACE("row " + std::to_string(k));
    const TrackRow &a = device[k], &b = host[k];
    EXPECT_EQ(a.status, b.status);
    EXPECT_EQ(a.circle_ok, b.circle_ok);
    EXPECT_EQ(a.motion_ok, b.motion_ok);
    if (!a.circle_ok || !b.circle_ok) continue;
    differ += a.cx_px != b.cx_px ? 1 : 0;
    const auto hold = [&](double one, double other, double sd) {
      const double off = (one - other) / sd;
      EXPECT_LT(std::abs(off), 0.3);
      squares += off * off;
      ++held;
    };
    hold(a.cx_px, b.cx_px, b.cx_sd_px);
    hold(a.cy_px, b.cy_px, b.cy_sd_px);
    hold(a.r_px, b.r_px, b.r_sd_px);
    EXPECT_NEAR(a.cx_sd_px, b.cx_sd_px, 0.05 * b.cx_sd_px);
    EXPECT_NEAR(a.r_sd_px, b.r_sd_px, 0.05 * b.r_sd_px);
    if (!a.motion_ok || !b.motion_ok) continue;
    hold(a.dx_px, b.dx_px, b.dx_sd_px);
    hold(a.dy_px, b.dy_px, b.dy_sd_px);
    hold(a.rot_deg, b.rot_deg, b.rot_sd_deg);
  }
  EXPECT_LT(std::sqrt(squares / std::max(held, 1)), 0.03);
  return differ;
}

SynthScene scene_of(int width, int height) {
  SynthScene scene;
  scene.width = width;
  scene.height = height;
  scene.noise_sigma = 2;
  return scene;
}

// It falls, is hit and flies off, past the picture's edge in the end.
RenderedClip bounce() {
  std::vector<BallPose> poses;
  double x = 70, y = 62, vx = 0.9, vy = 0.2, angle = 0, spin = 0.8;
  for (int k = 0; k < 150; ++k) {
    poses.push_back(pose(x, y, angle));
    x += vx;
    y += vy;
    angle += spin;
    vy += 0.012;
    if (k == 70) vy = -0.8 * vy, vx = 0.7, spin = 2.1;
  }
  return RenderedClip(quick_ball(3, 45), scene_of(200, 150), std::move(poses));
}

TEST(DeviceCircles, ATrackIsTheSame) {
  RenderedClip clip = bounce();
  const Tracked host = track_with(clip, false), device = track_with(clip, true);
  EXPECT_FALSE(host.asked);
  EXPECT_TRUE(device.asked);
  const int differ = expect_alike(device.rows, host.rows);
  EXPECT_GT(differ, 20);  // the device has had a part in those
}

// A frame whose ball is elsewhere than expected, a dark frame, and one that is another's twin: what
// the device does not find is the host's, and the part of the frame is cut anew.
TEST(DeviceCircles, WhatIsNotAsExpectedIsTheHosts) {
  std::vector<BallPose> poses;
  for (int k = 0; k < 100; ++k) poses.push_back(pose(60 + 0.4 * k, 64 + 0.1 * k, 1.1 * k));
  poses[52] = pose(60 + 0.4 * 52 + 40, 64 + 0.1 * 52, 1.1 * 52);
  RenderedClip source(quick_ball(3, 40), scene_of(170, 150), poses);
  std::vector<Frame> frames(poses.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    source.read(static_cast<std::int64_t>(k), frames[k]);
  }
  std::fill_n(frames[75].u8.data(), frames[75].u8.size(), std::uint8_t{30});
  frames[82] = frames[81];
  MemoryClip clip(std::move(frames));
  const Tracked host = track_with(clip, false), device = track_with(clip, true);
  EXPECT_TRUE(device.asked);
  EXPECT_GT(expect_alike(device.rows, host.rows), 40);
  EXPECT_FALSE(device.rows[75].circle_ok);
  EXPECT_NEAR(device.rows[52].cx_px, poses[52].cx_px, 0.1);
}

}  // namespace
}  // namespace impactdic::testing
