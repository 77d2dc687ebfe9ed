// Displacement fields in a camera's plane of motion.
#include "host/camera/plane_field.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "host/camera/spread.h"
#include "host/run/camera/plane_motion.h"
#include "kernels/types.h"
#include "tests/support/camera/test_camera.h"
#include "tests/support/camera/through_lens.h"

namespace impactdic::testing {
namespace {

using camera::PlaneView;
using Eigen::Vector2d;
using P = CameraParameter;

constexpr double kMetrePerPx = 3e-4;
constexpr int kSide = 512, kWindow = 15;

// A rigid motion of the plane of motion about `centre`, world axes.
struct Rigid {
  Vector2d shift;
  double angle;
  Vector2d centre;
  Vector2d operator()(const Vector2d& at) const {
    return Eigen::Rotation2Dd(angle) * (at - centre) + centre + shift;
  }
};

// What `camera` would see of windows on a grid in `roi` if the plane moved so.
struct Seen {
  std::vector<Window> windows;
  std::vector<WindowMotion> field;
};
Seen film(const Camera& camera, const Roi& roi, const Rigid& motion) {
  const PlaneView plane(camera);
  Seen seen;
  for (int y = roi.y; y + kWindow <= roi.y + roi.height; y += kWindow) {
    for (int x = roi.x; x + kWindow <= roi.x + roi.width; x += kWindow) {
      Window window{};
      window.x0 = x, window.y0 = y;
      const Vector2d at(x + (kWindow - 1) / 2.0, y + (kWindow - 1) / 2.0);
      const Vector2d to = motion(plane.to_plane(at));
      const Vector2d moved = plane.to_picture({to.x(), to.y(), 0}) - at;
      WindowMotion one{};
      one.status = static_cast<std::int32_t>(WindowStatus::kOk);
      one.u = static_cast<float>(moved.x()), one.v = static_cast<float>(moved.y());
      one.u_sd = one.v_sd = 0.005F;
      seen.windows.push_back(window);
      seen.field.push_back(one);
    }
  }
  return seen;
}

MotionRow row_of(const Vector2d& shift_px, double angle_rad) {
  MotionRow row;
  row.motion_ok = true;
  row.dx_px = shift_px.x(), row.dy_px = shift_px.y();
  row.rot_deg = angle_rad * kDegPerRad;
  row.dx_sd_px = row.dy_sd_px = 0.001;
  row.rot_sd_deg = 0.001;
  return row;
}

TEST(PlaneField, ARigidMotionThroughALensIsRigidAgain) {
  const Camera camera = bent_camera(kSide, kMetrePerPx, 0.02);
  const PlaneView plane(camera);
  const Roi roi{40, 60, 300, 180};
  const Vector2d centre(40 + 299 / 2.0, 60 + 179 / 2.0);
  const Rigid truth{{0.0021, -0.0009}, 0.02, plane.to_plane(centre)};
  const Seen seen = film(camera, roi, truth);
  CorrelateRequest request;
  run::PlaneMotion motion(camera, seen.windows, request, roi, kWindow);
  // About what a fit to the picture says.
  MotionRow row = row_of({truth.shift.x() / kMetrePerPx, -truth.shift.y() / kMetrePerPx}, 0.02);
  const auto results = motion.correct(seen.field, row);
  ASSERT_EQ(results.size(), seen.windows.size());
  constexpr double kFloat_m = 1e-6 * kMetrePerPx * 10;  // displacements are floats of some px
  for (const PlaneResult& one : results) {
    const Vector2d at(one.x_m, one.y_m), moved(one.u_m, one.v_m);
    EXPECT_LT((truth(at) - at - moved).norm(), kFloat_m);
    EXPECT_NEAR(one.u_sd_m, 0.005 * kMetrePerPx, 0.05 * 0.005 * kMetrePerPx);
  }
  EXPECT_NEAR(row.dx_m, truth.shift.x(), kFloat_m);
  EXPECT_NEAR(row.dy_m, truth.shift.y(), kFloat_m);
  EXPECT_NEAR(row.plane_rot_deg, 0.02 * kDegPerRad, 1e-5);
}

// Without distortion and square to the plane, the plane shows what the picture shows.
TEST(PlaneField, WithoutALensPixelsAreMetres) {
  const Camera camera = bent_camera(kSide, kMetrePerPx, 0);
  const Roi roi{100, 100, 200, 200};
  CorrelateRequest request;
  request.motion = RegionMotion::kRegion;
  run::PlaneMotion motion(camera, {}, request, roi, kWindow);
  MotionRow row = row_of({3.5, -1.25}, -0.3);
  EXPECT_TRUE(motion.correct({}, row).empty());
  EXPECT_NEAR(row.dx_m, 3.5 * kMetrePerPx, 1e-12);
  EXPECT_NEAR(row.dy_m, 1.25 * kMetrePerPx, 1e-12);  // up
  EXPECT_NEAR(row.plane_rot_deg, -0.3 * kDegPerRad, 1e-9);
  EXPECT_NEAR(row.dx_sd_m, 0.001 * kMetrePerPx, 1e-12);
  MotionRow reference;
  reference.is_reference = reference.motion_ok = true;
  motion.correct({}, reference);
  EXPECT_EQ(reference.dx_m, 0);
  MotionRow lost;
  motion.correct({}, lost);
  EXPECT_TRUE(std::isnan(lost.dx_m));
}

// What of the camera is not known is part of the deviations.
TEST(PlaneField, TheCamerasDeviationIsPartOfTheRegions) {
  Camera camera = askew_camera();
  camera.covariance = {};
  const auto state = [&](P parameter, double sd) {
    camera.covariance[static_cast<std::size_t>(parameter) * (kCameraParameters + 1)] = sd * sd;
  };
  state(P::kPositionZ, 0.004 * camera[P::kPositionZ]);
  const Roi roi{camera.width / 4, camera.height / 4, camera.width / 3, camera.height / 3};
  CorrelateRequest request;
  request.motion = RegionMotion::kRegion;
  MotionRow row = row_of({20, -6}, 0.01);
  run::PlaneMotion(camera, {}, request, roi, kWindow).correct({}, row);
  // Of a plane that is farther away every length is longer by as much.
  EXPECT_NEAR(row.dx_sd_m, 0.004 * std::abs(row.dx_m), 0.2 * 0.004 * std::abs(row.dx_m));
  EXPECT_GT(row.dy_sd_m, 0.2 * 0.004 * std::abs(row.dy_m));
  Camera exact = camera;
  exact.covariance = {};
  MotionRow without = row_of({20, -6}, 0.01);
  run::PlaneMotion(exact, {}, request, roi, kWindow).correct({}, without);
  EXPECT_LT(without.dx_sd_m, 0.2 * row.dx_sd_m);
  EXPECT_DOUBLE_EQ(without.dx_m, row.dx_m);
}

}  // namespace
}  // namespace impactdic::testing
