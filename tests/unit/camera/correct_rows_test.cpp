// A ball through a lens and back, and a whole shot through a camera.
#include "host/camera/correct_rows.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>

#include "host/run/metres/camera_part.h"
#include "tests/support/camera/test_camera.h"
#include "tests/support/camera/through_lens.h"
#include "tests/support/filmed_shot.h"

namespace impactdic::testing {
namespace {

using camera::BallInPlane;
using camera::BallView;
using camera::CircleInPicture;
using camera::PlaneView;
using camera::TurnInPlane;
using Eigen::Vector2d;
using P = CameraParameter;

constexpr double kRounding_px = 1e-8;
constexpr double kMetrePerPx = 3e-4;

TEST(BallView, WithoutALensNothingIsCorrected) {
  const Camera camera = bent_camera(512, 3e-4, 0);
  const PlaneView plane(camera);
  const BallView view(plane, false, 4);
  const BallInPlane ball = view.ball({{140, 390}, 61});
  EXPECT_NEAR(ball.centre.x(), 140 * 3e-4, 1e-12);
  EXPECT_NEAR(ball.centre.y(), (511 - 390) * 3e-4, 1e-12);
  EXPECT_NEAR(ball.radius, 61 * 3e-4, 1e-12);
  const TurnInPlane motion = view.motion(ball, {{140, 390}, 61}, {{2.5, -1.5}, 0.03});
  EXPECT_NEAR(motion.shift.x(), 2.5 * 3e-4, 1e-12);
  EXPECT_NEAR(motion.shift.y(), 1.5 * 3e-4, 1e-12);  // up
  EXPECT_NEAR(motion.angle, 0.03, 1e-12);
}

TEST(BallView, BackFromThePictureToTheBall) {
  const Camera camera = askew_camera();
  const PlaneView plane(camera);
  for (const bool sphere : {false, true}) {
    const BallView view(plane, sphere, 4);
    const BallInPlane ball{{0.09, 0.05}, 0.033};
    const CircleInPicture circle = view.circle(ball);
    const BallInPlane back = view.ball(circle);
    EXPECT_LT((back.centre - ball.centre).norm(), 1e-12);
    EXPECT_NEAR(back.radius, ball.radius, 1e-12);
    const TurnInPlane motion{{0.002, -0.001}, 0.05};
    const TurnInPlane seen = view.motion_in_picture(ball, circle, motion);
    const TurnInPlane found = view.motion(ball, circle, seen);
    EXPECT_LT((found.shift - motion.shift).norm(), 1e-12);
    EXPECT_NEAR(found.angle, motion.angle, 1e-10);
  }
}

// Few points stand for the outline and the disc: against very many. What lies beyond the
// margin inside the rim is not registered, and does not count.
TEST(BallView, FewPointsAreEnough) {
  const Camera camera = bent_camera(512, 3e-4);
  const PlaneView plane(camera);
  constexpr double kMargin_px = 5;
  const BallView view(plane, false, kMargin_px);
  const BallInPlane ball{{0.03, 0.12}, 0.025};
  const TurnInPlane motion{{0.0007, -0.0004}, 0.05};
  const CircleInPicture circle = view.circle(ball);
  const TurnInPlane seen = view.motion_in_picture(ball, circle, motion);
  constexpr int kMany = 200;
  const double reach = ball.radius * (1 - kMargin_px / circle.radius);
  Vector2d before_mean(0, 0), after_mean(0, 0);
  std::vector<Vector2d> before, after;
  const Eigen::Rotation2Dd turn(motion.angle);
  for (int i = 0; i < kMany; ++i) {
    for (int k = 0; k < kMany; ++k) {
      const double radius = reach * std::sqrt((i + 0.5) / kMany);
      const Vector2d off =
          radius * Vector2d(std::cos(2 * kPi * k / kMany), std::sin(2 * kPi * k / kMany));
      const Vector2d a = ball.centre + off;
      const Vector2d b = ball.centre + motion.shift + turn * off;
      before.push_back(plane.to_picture({a.x(), a.y(), 0}));
      after.push_back(plane.to_picture({b.x(), b.y(), 0}));
      before_mean += before.back() / (kMany * kMany);
      after_mean += after.back() / (kMany * kMany);
    }
  }
  double sine = 0, cosine = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Vector2d a = before[i] - before_mean, b = after[i] - after_mean;
    cosine += a.dot(b);
    sine -= a.x() * b.y() - a.y() * b.x();
  }
  const double angle = std::atan2(sine, cosine);
  const Vector2d shift =
      after_mean + Eigen::Rotation2Dd(-angle) * (circle.centre - before_mean) - circle.centre;
  EXPECT_LT((shift - seen.shift).norm(), 2e-5);  // px, of 3 px
  EXPECT_NEAR(seen.angle, angle, 2e-6);
}

// On the axis the outline of a sphere is f R / sqrt(D^2 - R^2) wide (sphere of radius R at D).
TEST(BallView, ASphereShowsMoreThanItsEquator) {
  const Camera camera = bent_camera(513, 3e-4, 0);
  const PlaneView plane(camera);
  const double distance = camera[P::kPositionZ], radius = 0.06;
  const CircleInPicture circle =
      BallView(plane, true, 0).circle({{256 * 3e-4, 256 * 3e-4}, radius});
  const double expected =
      camera[P::kFx] * radius / std::sqrt(distance * distance - radius * radius);
  EXPECT_NEAR(circle.radius, expected, kRounding_px);
  EXPECT_LT((circle.centre - Vector2d(256, 256)).norm(), kRounding_px);
}

TEST(RowCorrection, AFlightOfConstantSpeedStaysOne) {
  const Camera camera = bent_camera(512, 3e-4);
  std::vector<TrackRow> rows;
  for (int i = 0; i < 60; ++i) {
    TrackRow row;
    row.frame = i;
    row.circle_ok = row.motion_ok = true;
    row.cx_px = 80 + 5.5 * i, row.cy_px = 60 + 5 * i, row.r_px = 55;
    row.cx_sd_px = row.cy_sd_px = row.r_sd_px = row.dx_sd_px = row.dy_sd_px = 0.01;
    row.rot_sd_deg = 0.001;
    row.dx_px = 5.5, row.dy_px = 5, row.rot_deg = 2;
    rows.push_back(row);
  }
  const std::vector<TrackRow> seen = through_lens(camera, rows, 3e-4);
  EXPECT_GT(std::abs(seen[0].dx_px - seen[30].dx_px), 0.05);  // the lens is felt
  EXPECT_GT(std::abs(seen[0].cx_px - rows[0].cx_px), 1);
  const std::vector<TrackRow> back =
      camera::RowCorrection(camera, false, 3e-4, dic::kRimMarginPx).correct(seen);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NEAR(back[i].cx_px, rows[i].cx_px, kRounding_px);
    EXPECT_NEAR(back[i].cy_px, rows[i].cy_px, kRounding_px);
    EXPECT_NEAR(back[i].r_px, rows[i].r_px, kRounding_px);
    EXPECT_NEAR(back[i].dx_px, rows[i].dx_px, kRounding_px);
    EXPECT_NEAR(back[i].dy_px, rows[i].dy_px, kRounding_px);
    EXPECT_NEAR(back[i].rot_deg, rows[i].rot_deg, kRounding_px);
    EXPECT_NEAR(back[i].cx_sd_px, 0.01, 5e-4);  // 3 % at most
  }
}

struct ShotInCamera {
  FilmedShot shot;
  Camera camera;
};

ShotInCamera shot_in_camera(ScaleBy by) {
  std::mt19937_64 random(5);
  ShotInCamera made{filmed_shot(random, by), {}};
  FilmedShot& shot = made.shot;
  constexpr int kSide = 1024;
  made.camera = bent_camera(kSide, shot.filmed.metre_per_px);
  shot.result.scale.image_height = kSide;
  // The touch comes to the picture's middle.
  const TrackRow middle = shot.result.rows[static_cast<std::size_t>(shot.truth.start)];
  for (TrackRow& row : shot.result.rows) {
    row.cx_px += kSide / 2.0 - middle.cx_px;
    row.cy_px += kSide / 2.0 - middle.cy_px;
  }
  return made;
}

TEST(CameraPart, AShotThroughTheLensHasTheSameFigures) {
  for (const ScaleBy by : {ScaleBy::kDiameter, ScaleBy::kRuler}) {
    const ShotInCamera made = shot_in_camera(by);
    FilmedShot straight = made.shot;
    if (by == ScaleBy::kRuler) {
      straight.request.mm_per_px = straight.filmed.metre_per_px * 1e3;
      straight.request.mm_per_px_sd = 0;
    }
    straight.conclude();
    FilmedShot bent = made.shot;
    bent.request.mm_per_px = bent.request.mm_per_px_sd = 0;
    bent.result.rows = through_lens(made.camera, made.shot.result.rows, bent.filmed.metre_per_px);
    conclude_through(made.camera, bent);
    const ImpactFigures &a = straight.result.impact_si, &b = bent.result.impact_si;
    ASSERT_EQ(b.status, ImpactStatus::kFound);
    // Weights differ a little: a deviation is a little larger where the lens enlarges less.
    constexpr double kShare = 0.1;  // of a deviation
    EXPECT_NEAR(a.before.vn.value, b.before.vn.value, kShare * a.before.vn.sd);
    EXPECT_NEAR(a.after.vt.value, b.after.vt.value, kShare * a.after.vt.sd);
    EXPECT_NEAR(a.restitution.value, b.restitution.value, kShare * a.restitution.sd);
    EXPECT_NEAR(a.max_deflection_m.value, b.max_deflection_m.value, kShare * a.max_deflection_m.sd);
    EXPECT_NEAR(a.before.vn.sd, b.before.vn.sd, 0.05 * a.before.vn.sd);
    EXPECT_EQ(b.budget(ImpactFigure::kVnBefore)[static_cast<std::size_t>(ErrorSource::kCamera)], 0);
    if (by == ScaleBy::kDiameter) {
      const Measured& before = bent.result.camera->before_plane_m;
      EXPECT_LT(std::abs(before.value), 4 * before.sd);  // the ball flies in the plane
    }
  }
}

// A camera that is not exact, and the shot that it films.
ShotInCamera shot_in_uncertain_camera() {
  ShotInCamera made = shot_in_camera(ScaleBy::kRuler);
  FilmedShot& shot = made.shot;
  shot.request.mm_per_px = shot.request.mm_per_px_sd = 0;
  shot.result.rows = through_lens(made.camera, shot.result.rows, shot.filmed.metre_per_px);
  Camera& camera = made.camera;
  const auto set = [&](P p, double sd) {
    camera.covariance[static_cast<std::size_t>(p) * (kCameraParameters + 1)] = sd * sd;
  };
  set(P::kPositionZ, 0.002 * camera[P::kPositionZ]);
  set(P::kK1, 0.2 * camera[P::kK1]);
  set(P::kRotationX, 0.01);
  set(P::kRotationY, 0.01);
  return made;
}

// What cameras drawn by the covariance make of the same rows.
std::vector<ImpactFigures> drawn_figures(const ShotInCamera& made, int cameras, double scale) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal(0, 1);
  std::vector<ImpactFigures> drawn;
  for (int i = 0; i < cameras; ++i) {
    Camera one = made.camera;
    for (std::size_t p = 0; p < kCameraParameters; ++p) {
      one.values[p] += std::sqrt(made.camera.variance(static_cast<P>(p))) * normal(random);
    }
    TrackResult result = made.shot.result;
    result.rows =
        camera::RowCorrection(one, false, scale, dic::kRimMarginPx).correct(made.shot.result.rows);
    TrackRequest request = made.shot.request;
    request.mm_per_px = scale * 1e3;
    run::conclude_metres(request, std::nullopt, result);
    drawn.push_back(result.impact_si);
  }
  return drawn;
}

const Measured& figure(const ImpactFigures& figures, ImpactFigure which) {
  if (which == ImpactFigure::kVnBefore) return figures.before.vn;
  if (which == ImpactFigure::kVtAfter) return figures.after.vt;
  return figures.restitution;
}

// The part that the camera has in each deviation, against cameras drawn by its covariance.
TEST(CameraPart, IsTheScatterOfTheFiguresOverCameras) {
  const ShotInCamera made = shot_in_uncertain_camera();
  TrackResult found = made.shot.result;
  run::conclude_through_camera(made.camera, made.shot.request, found.rows, std::nullopt, found);
  ASSERT_EQ(found.impact_si.status, ImpactStatus::kFound);
  constexpr int kCameras = 80;  // a deviation of them is known to 8 %
  const auto drawn = drawn_figures(made, kCameras, found.camera->metre_per_px.value);
  for (const ImpactFigure which :
       {ImpactFigure::kVnBefore, ImpactFigure::kVtAfter, ImpactFigure::kRestitution}) {
    double sum = 0, squares = 0;
    for (const ImpactFigures& one : drawn) {
      const double value = figure(one, which).value;
      sum += value, squares += value * value;
    }
    const double mean = sum / kCameras, sd = std::sqrt(squares / kCameras - mean * mean);
    const ErrorParts& parts = found.impact_si.budget(which);
    const double part = parts[static_cast<std::size_t>(ErrorSource::kCamera)];
    EXPECT_GT(part, 0) << to_string(which);
    EXPECT_NEAR(part, sd, 0.3 * sd) << to_string(which);
    // The parts are the whole deviation.
    double all = 0;
    for (const double one : parts) all += one * one;
    const double stated = figure(found.impact_si, which).sd;
    EXPECT_NEAR(std::sqrt(all), stated, 0.01 * stated) << to_string(which);
  }
  // Rows hold the common part, too.
  const SiRow with = to_si(found, 3), without = to_si(found.camera->rows[3], found.scale);
  EXPECT_GT(std::hypot(with.vx_sd_m_s, with.vy_sd_m_s),
            1.2 * std::hypot(without.vx_sd_m_s, without.vy_sd_m_s));
}

// A ball that is larger in the picture than its diameter says lies before the plane.
TEST(CameraPart, TheBallsSizeTellsItsDepth) {
  ShotInCamera made = shot_in_camera(ScaleBy::kDiameter);
  FilmedShot& shot = made.shot;
  const double distance = made.camera[P::kPositionZ];
  constexpr double kNearer = 0.05;
  for (TrackRow& row : shot.result.rows) row.r_px /= 1 - kNearer;
  shot.result.rows = through_lens(made.camera, shot.result.rows, shot.filmed.metre_per_px);
  conclude_through(made.camera, shot);
  const Measured& before = shot.result.camera->before_plane_m;
  EXPECT_NEAR(before.value, kNearer * distance, 4 * before.sd);
  EXPECT_LT(before.sd, 0.01 * distance);
  EXPECT_NEAR(shot.result.scale.metre_per_px, (1 - kNearer) * shot.filmed.metre_per_px,
              4 * shot.result.scale.metre_per_px_sd);
}

TEST(CameraPart, PicturesOfAnotherSizeAreRefused) {
  ClipInfo clip;
  clip.width = 640;
  clip.height = 480;
  const Camera camera = bent_camera(512, 3e-4);
  EXPECT_THROW(run::check_camera_fits(camera, clip, "camera.toml"), InvalidArgument);
}

}  // namespace
}  // namespace impactdic::testing
