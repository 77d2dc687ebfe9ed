// A camera that shakes or pans: what is measured is against the still background.
#include <gtest/gtest.h>
#include <impactdic/track.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "host/clip/steady_rows.h"
#include "tests/support/rendered_clip.h"
#include "tests/support/warnings.h"

namespace impactdic::testing {
namespace {

constexpr int kWidth = 320, kHeight = 224, kFrames = 40;
constexpr double kRadius = 45;
constexpr double kStepX = 1.7, kStepY = -0.6, kTurn = 0.9;  // px, px, degrees a frame
constexpr double kMiddleX = 0.5 * (kWidth - 1), kMiddleY = 0.5 * (kHeight - 1);
constexpr double kBlur_px = 0.67;  // of the rendered lens, with a pixel's own

struct Shake {
  double x_px = 0, y_px = 0, roll_rad = 0;
};
using CameraPath = std::function<Shake(double frame)>;

// Smooth blotches, known everywhere.
class Wall {
 public:
  explicit Wall(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(0, 1);
    for (Wave& wave : waves_) {
      const double length_px = 9 + 22 * any(random), towards = 2 * kPi * any(random);
      wave = {2 * kPi / length_px * std::cos(towards), 2 * kPi / length_px * std::sin(towards),
              2 * kPi * any(random)};
    }
  }
  double operator()(double x, double y) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::sin(wave.x * x + wave.y * y + wave.phase);
    return 5 * sum;
  }

 private:
  struct Wave {
    double x, y, phase;
  };
  std::array<Wave, 14> waves_;
};

struct Film {
  CameraPath camera = [](double) { return Shake{}; };
  bool textured = true;
  bool ball_shakes = true;  // false: the wall does by itself
  double curtain_px = 0;    // a frame: of the left third of the wall
  double noise = 2;
};

double covered(double distance) {
  return 0.5 * std::erfc((distance - kRadius) / (std::sqrt(2.0) * kBlur_px));
}

void paint_wall(const Film& film, const Wall& wall, const Shake& at, const BallPose& ball,
                double frame, Frame& picture) {
  const double c = std::cos(at.roll_rad), s = std::sin(at.roll_rad);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double px = x - kMiddleX - at.x_px, py = y - kMiddleY - at.y_px;
      const double moved = x < kWidth / 3 ? film.curtain_px * frame : 0;
      const double level = wall(c * px + s * py + moved, -s * px + c * py);
      const double shown = 1 - covered(std::hypot(x - ball.cx_px, y - ball.cy_px));
      std::uint8_t& pixel = picture.u8.data()[y * kWidth + x];
      pixel = static_cast<std::uint8_t>(std::clamp(pixel + level * shown + 0.5, 0.0, 255.0));
    }
  }
}

std::vector<Frame> taken(const Film& film) {
  SynthScene scene;
  scene.width = kWidth;
  scene.height = kHeight;
  scene.noise_sigma = film.noise;
  scene.background = 90;
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("e1", 3, kRadius), scene);
  const Wall wall(11);
  std::vector<Frame> frames(kFrames);
  for (int k = 0; k < kFrames; ++k) {
    const Shake at = film.camera(k);
    const double x = 80.3 + kStepX * k - kMiddleX, y = 130.8 + kStepY * k - kMiddleY;
    const Shake of_ball = film.ball_shakes ? at : Shake{};
    const double c = std::cos(of_ball.roll_rad), s = std::sin(of_ball.roll_rad);
    const BallPose ball = {kMiddleX + of_ball.x_px + c * x - s * y,
                           kMiddleY + of_ball.y_px + s * x + c * y,
                           kTurn * k - of_ball.roll_rad * kDegPerRad};
    renderer.render(ball, k, frames[static_cast<std::size_t>(k)]);
    if (film.textured) {
      paint_wall(film, wall, at, ball, k, frames[static_cast<std::size_t>(k)]);
    }
  }
  return frames;
}

TrackResult tracked(const Film& film, CameraMotionUse use = CameraMotionUse::kCorrect) {
  static Session session;
  TrackRequest request;
  request.clip.source = std::make_shared<MemoryClip>(taken(film));
  request.clip.fps = 10000;
  request.mm_per_px = 1000;  // m/s are 10 000 px/frame
  request.camera_motion = use;
  return track(request, session);
}

Shake trembling(double k) {
  return {0.3 * std::sin(0.8 * k), 0.4 * std::cos(0.55 * k), 0.0015 * std::sin(0.31 * k)};
}

bool says_that_it_moves(const TrackResult& result) { return says(result, "the background moves"); }

void expect_flight(const TrackResult& result) {
  const FlightMotion& flight = result.impact.flight;
  ASSERT_GT(flight.last, flight.first);
  EXPECT_NEAR(flight.vx.value, kStepX, 4 * flight.vx.sd);
  EXPECT_NEAR(flight.spin.value, kTurn * kRadPerDeg, 4 * flight.spin.sd);
  EXPECT_LT(flight.vx.sd, 0.003);
  EXPECT_LT(flight.spin.sd, 1e-4);
}

// As a racket or a thin floor does that a ball strikes.
TEST(ShakenCamera, AWallThatMovesByItselfIsNoCamera) {
  const TrackResult result = tracked({.camera = trembling, .ball_shakes = false});
  EXPECT_FALSE(result.camera_motion);
  EXPECT_FALSE(says_that_it_moves(result));
  EXPECT_TRUE(says(result, "a surface that gives way"));
  expect_flight(result);
}

TEST(ShakenCamera, VelocitiesAreAgainstTheBackground) {
  const TrackResult result = tracked({.camera = trembling});
  ASSERT_TRUE(result.camera_motion);
  EXPECT_TRUE(says_that_it_moves(result));
  const Shake first = trembling(0);
  double shifts = 0, rolls = 0, speeds = 0, spins = 0;
  for (std::size_t i = 0; i + 1 < result.rows.size(); ++i) {
    const PictureShift& shift = result.camera_motion->of_rows[i];
    ASSERT_TRUE(shift.known) << i;
    const Shake at = trembling(static_cast<double>(i));
    EXPECT_LT(shift.x_sd_px, 0.01);
    shifts += std::pow((shift.x_px - (at.x_px - first.x_px)) / shift.x_sd_px, 2);
    rolls += std::pow((shift.roll_rad - (at.roll_rad - first.roll_rad)) / shift.roll_sd_rad, 2);
    ASSERT_EQ(result.rows[i].status, TrackStatus::kOk) << i;
    const SiRow si = to_si(result, i);
    speeds += std::pow((si.vx_m_s - kStepX * 1e4) / si.vx_sd_m_s, 2);
    speeds += std::pow((si.vy_m_s + kStepY * 1e4) / si.vy_sd_m_s, 2);
    spins += std::pow((si.omega_rad_s - kTurn * kRadPerDeg * 1e4) / si.omega_sd_rad_s, 2);
  }
  const double rows = kFrames - 1;
  for (const double square : {shifts / rows, rolls / rows, speeds / (2 * rows), spins / rows}) {
    EXPECT_LT(std::sqrt(square), 1.4);
    EXPECT_GT(std::sqrt(square), 0.5);
  }
  expect_flight(result);
}

TEST(ShakenCamera, ItCanBeIgnored) {
  const TrackResult result = tracked({.camera = trembling}, CameraMotionUse::kIgnore);
  EXPECT_FALSE(result.camera_motion);
  EXPECT_FALSE(says_that_it_moves(result));
  EXPECT_NEAR(to_si(result, 5).vx_m_s, result.rows[5].dx_px * 1e4, 1e-6);
}

// Nothing shows that it is the camera; but that something is wrong.
TEST(ShakenCamera, BeforeAnEvenBackgroundThePathIsRough) {
  const auto is_rough = [](const TrackResult& result) {
    return says(result, "the ball's steps differ from those beside");
  };
  EXPECT_TRUE(is_rough(tracked({.camera = trembling, .textured = false})));
  EXPECT_FALSE(is_rough(tracked({.camera = trembling})));
  EXPECT_FALSE(is_rough(tracked({.textured = false})));
}

TEST(ShakenCamera, ItPansWithTheBall) {
  const CameraPath pans = [](double k) { return Shake{-1.4 * k, 0.5 * k, 0}; };
  const TrackResult result = tracked({.camera = pans});
  ASSERT_TRUE(result.camera_motion);
  expect_flight(result);
}

// Of the three that may be taken for a shake none is.
TEST(ShakenCamera, AStillCameraIsLeftAlone) {
  for (const Film& film : {Film{}, Film{.textured = false}, Film{.curtain_px = 0.2}}) {
    const TrackResult result = tracked(film);
    EXPECT_FALSE(result.camera_motion) << film.textured << film.curtain_px;
    EXPECT_FALSE(says_that_it_moves(result));
    EXPECT_NEAR(to_si(result, 5).vx_m_s, result.rows[5].dx_px * 1e4, 1e-6);
  }
}

TEST(ShakenCamera, NothingIsStatedWhereTheBackgroundWasNotFound) {
  CameraMotion motion;
  motion.of_rows.resize(3);
  motion.of_rows[0] = motion.of_rows[2] = {true, 0.5, 0, 0, 0.01, 0.01, 1e-5};
  TrackRow row;
  row.circle_ok = row.motion_ok = true;
  row.status = TrackStatus::kOk;
  row.cx_px = row.cy_px = 30, row.dx_px = row.dy_px = row.rot_deg = 1;
  const TrackRow before = steadied(row, 0, motion), there = steadied(row, 1, motion);
  EXPECT_TRUE(before.circle_ok);
  EXPECT_DOUBLE_EQ(before.cx_px, 29.5);
  EXPECT_FALSE(before.motion_ok || there.motion_ok || there.circle_ok);
  EXPECT_TRUE(std::isnan(before.dx_px) && std::isnan(there.cx_px) && std::isnan(there.rot_deg));
}

// A sphere's turn between two pictures that are rolled: a roll turns the ball's picture, too.
TEST(ShakenCamera, RollsAreTakenOffASpheresTurns) {
  CameraMotion motion;
  motion.of_rows.resize(2);
  motion.of_rows[0] = {true, 0, 0, 0.2, 0, 0, 0};
  motion.of_rows[1] = {true, 0, 0, 0.5, 0, 0, 0};
  TrackRow row;
  row.frame = 1;
  row.circle_ok = true;
  row.cx_px = row.cy_px = 0;
  row.pose.ok = true;
  row.pose.origin = row.pose.keyframe = 0;
  row.pose.key_dx_px = row.pose.key_dy_px = 0;
  // A turn about the line of sight alone, which the roll hides.
  row.pose.key_rot_x_deg = row.pose.key_rot_y_deg = 0;
  row.pose.key_rot_deg = -0.3 * kDegPerRad;
  row.pose.qw = std::cos(0.15), row.pose.qx = row.pose.qy = 0, row.pose.qz = -std::sin(0.15);
  const BodyPose still = steadied(row, 1, motion).pose;
  EXPECT_NEAR(still.key_rot_deg, 0, 1e-9);
  EXPECT_NEAR(still.qz, 0, 1e-12);
  // About X before pictures that are rolled alike: the axis is rolled with them.
  motion.of_rows[1].roll_rad = 0.2;
  row.pose.key_rot_x_deg = 10 * std::cos(-0.2), row.pose.key_rot_y_deg = 10 * std::sin(-0.2);
  row.pose.key_rot_deg = 0;
  const BodyPose rolled = steadied(row, 1, motion).pose;
  EXPECT_NEAR(rolled.key_rot_x_deg, 10, 1e-9);
  EXPECT_NEAR(rolled.key_rot_y_deg, 0, 1e-9);
}

}  // namespace
}  // namespace impactdic::testing
