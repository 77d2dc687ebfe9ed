#include <gtest/gtest.h>
#include <impactdic/camera/model.h>
#include <impactdic/error.h>
#include <impactdic/units.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>

#include "host/camera/plane_view.h"
#include "tests/support/camera/test_camera.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

using camera::Lens;
using camera::PlaneView;
using Eigen::Vector2d;
using Eigen::Vector3d;
using P = CameraParameter;
using testing::askew_camera;

// Central differences of a smooth function over 1e-3 px or 1e-5 m leave about this share.
constexpr double kSlopeTolerance = 1e-6;
constexpr double kRounding_px = 1e-9;

TEST(Lens, DirectionUndoesProjection) {
  const Camera camera = askew_camera();
  const Lens lens(camera);
  for (double x = 0; x < camera.width; x += 71) {
    for (double y = 0; y < camera.height; y += 57) {
      EXPECT_LT((lens.project(lens.direction({x, y})) - Vector2d(x, y)).norm(), kRounding_px);
    }
  }
}

TEST(Lens, FollowsBrownsFormula) {
  const Camera camera = askew_camera();
  const double a = 0.11, b = -0.07, s = a * a + b * b;
  const double radial = 1 - 0.21 * s + 0.13 * s * s + 0.02 * s * s * s;
  const double x = a * radial + 2 * 0.0011 * a * b - 0.0007 * (s + 2 * a * a);
  const double y = b * radial + 0.0011 * (s + 2 * b * b) - 2 * 0.0007 * a * b;
  const Vector2d expected(1500 * x + 322.4, 1498 * y + 196.1);
  EXPECT_LT((Lens(camera).project({a, b}) - expected).norm(), kRounding_px);
}

TEST(Lens, SlopesAreThoseOfTheFunctions) {
  const Lens lens(askew_camera());
  const Vector2d direction(0.14, -0.08);
  Eigen::Matrix2d forward, back;
  const Vector2d point = lens.project(direction, &forward);
  lens.direction(point, &back);
  for (int i = 0; i < 2; ++i) {
    const Vector2d step = 1e-6 * Vector2d::Unit(i), step_px = 1e-3 * Vector2d::Unit(i);
    const Vector2d by_direction =
        (lens.project(direction + step) - lens.project(direction - step)) / 2e-6;
    const Vector2d by_pixel =
        (lens.direction(point + step_px) - lens.direction(point - step_px)) / 2e-3;
    EXPECT_LT((by_direction - forward.col(i)).norm(), kSlopeTolerance * forward.norm());
    EXPECT_LT((by_pixel - back.col(i)).norm(), kSlopeTolerance * back.norm());
  }
}

TEST(Lens, BeyondTheFoldThereIsNoDirection) {
  Camera camera = askew_camera();
  camera[P::kK1] = -30;  // folds at 0.105 of the focal length
  camera[P::kK2] = camera[P::kK3] = 0;
  EXPECT_TRUE(Lens(camera).direction({640, 400}).hasNaN());
  EXPECT_THROW(camera.validate(), InvalidArgument);
}

TEST(PlaneView, MetresLeadBackToThePicture) {
  const PlaneView view(askew_camera());
  for (const double z : {0.0, 0.05, -0.1}) {
    for (const Vector2d& point : {Vector2d(10, 20), Vector2d(600, 390), Vector2d(320, 200)}) {
      const Vector2d seen = view.to_plane(point, z);
      EXPECT_LT((view.to_picture({seen.x(), seen.y(), z}) - point).norm(), kRounding_px);
    }
  }
}

TEST(PlaneView, WorldAxesLieAlongThePicture) {
  const Camera camera = askew_camera();
  const PlaneView view(camera);
  EXPECT_LT(view.to_plane({0, camera.height - 1.0}).norm(), 1e-12);  // the origin
  const Vector2d middle((camera.width - 1) / 2.0, (camera.height - 1) / 2.0);
  const Vector2d along = view.to_plane(middle + Vector2d(1e-3, 0)) - view.to_plane(middle);
  EXPECT_GT(along.x(), 0);
  EXPECT_LT(std::abs(along.y()), kSlopeTolerance * along.x());
  const Vector2d up = view.to_plane(middle - Vector2d(0, 1)) - view.to_plane(middle);
  EXPECT_GT(up.y(), 0);
  EXPECT_GT(view.eye().z(), 0);
}

TEST(PlaneView, SlopesAreThoseOfTheFunctions) {
  const PlaneView view(askew_camera());
  const Vector3d world(0.05, 0.08, 0.02);
  Eigen::Matrix<double, 2, 3> by_world;
  const Vector2d point = view.to_picture(world, &by_world);
  for (int i = 0; i < 3; ++i) {
    const Vector3d step = 1e-5 * Vector3d::Unit(i);
    const Vector2d slope = (view.to_picture(world + step) - view.to_picture(world - step)) / 2e-5;
    EXPECT_LT((slope - by_world.col(i)).norm(), kSlopeTolerance * by_world.norm());
  }
  Eigen::Matrix2d by_pixel;
  view.to_plane(point, world.z(), &by_pixel);
  for (int i = 0; i < 2; ++i) {
    const Vector2d step = 1e-3 * Vector2d::Unit(i);
    const Vector2d slope =
        (view.to_plane(point + step, world.z()) - view.to_plane(point - step, world.z())) / 2e-3;
    EXPECT_LT((slope - by_pixel.col(i)).norm(), kSlopeTolerance * by_pixel.norm());
  }
}

// A camera that looks squarely at the plane from Z: a pixel is Z / f wide, and nearer points less.
TEST(PlaneView, SquareViewHasOneScale) {
  Camera camera;
  camera.width = camera.height = 101;
  camera[P::kFx] = camera[P::kFy] = 2000;
  camera[P::kCx] = camera[P::kCy] = 50;
  camera[P::kPositionZ] = 0.5;
  const PlaneView view(camera);
  EXPECT_NEAR(view.metre_per_px(), 0.5 / 2000, 1e-15);
  EXPECT_NEAR(view.metre_per_px(0.1), 0.4 / 2000, 1e-15);
  EXPECT_NEAR(view.tilt_rad(), 0, 1e-7);
  EXPECT_LT((view.to_plane({60, 30}) - Vector2d(60, 70) * (0.5 / 2000)).norm(), 1e-15);
  camera[P::kRotationX] = 0.1;
  camera.validate();
  EXPECT_NEAR(PlaneView(camera).tilt_rad(), 0.1, 1e-9);
}

TEST(CameraFile, ComesBackToTheLastBit) {
  const testing::ScratchFolder folder;
  const Camera camera = askew_camera();
  write_camera(camera, folder.file("camera.toml"));
  const Camera back = read_camera(folder.file("camera.toml"));
  EXPECT_EQ(back.width, camera.width);
  EXPECT_EQ(back.height, camera.height);
  EXPECT_EQ(back.from, camera.from);
  EXPECT_EQ(back.focal_length_known, camera.focal_length_known);
  EXPECT_EQ(back.values, camera.values);
  EXPECT_EQ(back.covariance, camera.covariance);
  EXPECT_FALSE(std::filesystem::exists(folder / "camera.toml.part"));
}

struct Damage {
  const char* from;
  const char* to;
  const char* says;
};

TEST(CameraFile, DamageIsOneClearLine) {
  const testing::ScratchFolder folder;
  write_camera(askew_camera(), folder.file("camera.toml"));
  const std::string good = testing::read_text(folder / "camera.toml");
  for (const Damage& damage :
       {Damage{"schema = 1", "schema = 2", "schema is 2"},
        Damage{"fx_px = 1500.0\n", "", "lens.fx_px is missing"},
        Damage{"fx_px = 1500.0", "fx_px = nan", "not finite"},
        Damage{"fx_px = 1500.0", "fx_px = -1500", "must be positive"},
        Damage{"fx_px = 1500.0", "fx_px = \"wide\"", "must hold numbers"},
        Damage{"k1 = -0.21", "k1 = -21.0", "folds the picture"},
        Damage{"k1 = -0.21", "k1 = -0.21\nk4 = 0.0", "lens.k4 is not known"},
        Damage{"width_px = 640", "width_px = 0", "no size"},
        Damage{"width_px = 640", "width_px = 640.5", "whole number"},
        Damage{"0.81]", "-0.81]", "before the camera"},
        Damage{"0.81]", "0.81, 1.0]", "a list of 3"},
        Damage{"focal_length_known = true", "focal_length_known = 1", "true or false"},
        Damage{"'fx_px', 'fy_px'", "'fy_px', 'fx_px'", "covariance.order"},
        Damage{"[1e-06,", "[-1e-06,", "variance is negative"},
        Damage{"[1e-06,", "[1e-12,", "negative variance"}, Damage{"[1e-06,", "[", "a list of 15"},
        Damage{"from = ", "from ", "no TOML"}}) {
    std::string text = good;
    const auto at = text.find(damage.from);
    ASSERT_NE(at, std::string::npos) << damage.from;
    text.replace(at, std::string(damage.from).size(), damage.to);
    std::ofstream(folder / "bad.toml") << text;
    try {
      read_camera(folder.file("bad.toml"));
      FAIL() << damage.says;
    } catch (const FormatError& error) {
      EXPECT_NE(error.line().find(damage.says), std::string::npos) << error.line();
      EXPECT_NE(error.line().find("bad.toml"), std::string::npos) << error.line();
    }
  }
  EXPECT_THROW(read_camera(folder.file("none.toml")), FileError);
}

TEST(CameraFile, AnImpossibleCameraIsNotWritten) {
  const testing::ScratchFolder folder;
  Camera camera = askew_camera();
  camera[P::kCx] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_camera(camera, folder.file("camera.toml")), InvalidArgument);
  EXPECT_FALSE(std::filesystem::exists(folder / "camera.toml"));
}

}  // namespace
}  // namespace impactdic
