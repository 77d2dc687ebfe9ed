// The circle on a real clip: a steel ball before a lamp, 12 bits, with a glint inside it and a
// plate below.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "host/circle/ball_tracker.h"
#include "host/video/frame_source.h"
#include "tests/support/data.h"

namespace impactdic {
namespace {

constexpr const char* kClip = "mraw/ball_12bit.cihx";

std::vector<circle::CircleFit> track_all(FrameSource& clip) {
  circle::BallTracker tracker;
  std::vector<circle::CircleFit> fits;
  Frame frame;
  for (std::int64_t i = 0; i < clip.info().frame_count; ++i) {
    clip.read(i, frame);
    fits.push_back(tracker.track(frame, i));
  }
  return fits;
}

// RMS about the least-squares quadratic, by orthogonal polynomials on equidistant points.
double rms_about_quadratic(std::vector<double> y) {
  const double n = static_cast<double>(y.size());
  const auto t = [&](std::size_t i) { return static_cast<double>(i) - (n - 1) / 2; };
  const std::vector<double (*)(double, double)> basis = {
      [](double, double) { return 1.0; }, [](double u, double) { return u; },
      [](double u, double m) { return u * u - (m * m - 1) / 12; }};
  for (const auto f : basis) {
    double fy = 0, ff = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      fy += f(t(i), n) * y[i];
      ff += f(t(i), n) * f(t(i), n);
    }
    for (std::size_t i = 0; i < y.size(); ++i) y[i] -= fy / ff * f(t(i), n);
  }
  double sum = 0;
  for (double v : y) sum += v * v;
  return std::sqrt(sum / n);
}

TEST(RealBall, FollowsAQuadraticInTime) {
  IMPACTDIC_NEED_DATA(kClip);
  const auto clip = video::open_video({testing::data_path(kClip).string()});
  const std::vector<circle::CircleFit> fits = track_all(*clip);
  ASSERT_EQ(fits.size(), 15u);
  std::vector<double> x, y;
  for (const circle::CircleFit& fit : fits) {
    ASSERT_EQ(fit.status, circle::CircleStatus::kOk);
    EXPECT_FALSE(fit.bright);
    EXPECT_FALSE(fit.ellipse);
    EXPECT_NEAR(fit.circle.r_px, 63.47, 0.15);
    EXPECT_GT(fit.rim_fraction, 0.9);
    x.push_back(fit.circle.cx_px);
    y.push_back(fit.circle.cy_px);
  }
  EXPECT_LE(rms_about_quadratic(x), 0.003);
  EXPECT_LE(rms_about_quadratic(y), 0.005);
  EXPECT_NEAR(std::hypot(x.back() - x.front(), y.back() - y.front()) / 14, 2.647, 0.005);
}

TEST(RealBall, EveryFrameAloneGivesTheSame) {
  IMPACTDIC_NEED_DATA(kClip);
  const auto clip = video::open_video({testing::data_path(kClip).string()});
  const std::vector<circle::CircleFit> fits = track_all(*clip);
  Frame frame;
  for (std::int64_t i = 0; i < clip->info().frame_count; i += 7) {
    clip->read(i, frame);
    const auto found = circle::find_ball(frame, {});
    ASSERT_TRUE(found);
    const circle::CircleFit alone = circle::measure_circle(frame, {.predicted = *found}, {});
    EXPECT_NEAR(alone.circle.cx_px, fits[i].circle.cx_px, 0.005);
    EXPECT_NEAR(alone.circle.cy_px, fits[i].circle.cy_px, 0.005);
  }
}

}  // namespace
}  // namespace impactdic
