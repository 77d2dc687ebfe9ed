// Pictures through a lens that bends straight lines.
#include "sim/speckle/lens.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <impactdic/synth.h>
#include <impactdic/units.h>

#include <cmath>

namespace impactdic::sim::speckle {
namespace {

SynthScene bent_scene(double k1, double k2) {
  SynthScene scene;
  scene.width = 200;
  scene.height = 160;
  scene.distortion_k1 = k1;
  scene.distortion_k2 = k2;
  return scene;
}

Vec bent(const SynthScene& scene, const Vec& at) {
  const double x = at.x - (scene.width - 1) / 2.0, y = at.y - (scene.height - 1) / 2.0;
  const double s = (x * x + y * y) / (std::hypot(scene.width, scene.height) / 2) /
                   (std::hypot(scene.width, scene.height) / 2);
  const double grow = s * (scene.distortion_k1 + s * scene.distortion_k2);
  return {at.x + grow * x, at.y + grow * y};
}

TEST(SynthLens, StraightenedUndoesTheLens) {
  const SynthScene scene = bent_scene(-0.05, 0.02);
  for (const Vec& at : {Vec{0, 0}, Vec{199, 159}, Vec{99.5, 79.5}, Vec{20, 100}}) {
    const Vec back = straightened(scene, bent(scene, at));
    EXPECT_NEAR(back.x, at.x, 1e-10);
    EXPECT_NEAR(back.y, at.y, 1e-10);
  }
}

// A plain white ball: area and centre of gravity of its picture are those of its bent outline.
TEST(SynthLens, ABallHasTheAreaAndCentreOfItsBentOutline) {
  SynthScene scene = bent_scene(0.06, -0.02);
  scene.background = 0;
  scene.white = 200;
  SpeckleBall ball;
  ball.radius_px = 40;
  const BallPose pose{60.3, 55.7};
  const BentRenderer renderer(std::make_unique<BallRenderer>(finer(ball), finer(scene)), scene);
  const Image<double> picture = renderer.exact(ShutterPath{pose, pose, pose});
  double sum = 0, x_sum = 0, y_sum = 0;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const double share = picture(x, y) / scene.white;
      sum += share, x_sum += share * x, y_sum += share * y;
    }
  }
  double area = 0, x_moment = 0, y_moment = 0;
  constexpr int kCorners = 2000;
  for (int i = 0; i < kCorners; ++i) {
    const auto corner = [&](int k) {
      const double angle = 2 * kPi * k / kCorners;
      return bent(scene, {pose.cx_px + 40 * std::cos(angle), pose.cy_px + 40 * std::sin(angle)});
    };
    const Vec a = corner(i), b = corner(i + 1);
    const double cross = a.x * b.y - a.y * b.x;
    area += cross / 2;
    x_moment += cross * (a.x + b.x) / 6, y_moment += cross * (a.y + b.y) / 6;
  }
  // The polygon lacks 2e-6 of the area; the lens's own magnification of the blur does the rest.
  EXPECT_NEAR(sum, area, 2e-4 * area);
  EXPECT_NEAR(x_sum / sum, x_moment / area, 2e-3);
  EXPECT_NEAR(y_sum / sum, y_moment / area, 2e-3);
  EXPECT_GT(std::abs(x_moment / area - pose.cx_px), 0.2);  // the lens is felt
}

// Almost no distortion: the picture is that of the renderer from formulas.
TEST(SynthLens, WithoutDistortionThePictureIsTheSame) {
  SynthScene scene = bent_scene(1e-12, 0);
  const SpeckleBall ball = paint_ball("e1", 1, 50);
  const BallPose pose{92.2, 81.4, 13};
  const BentRenderer renderer(std::make_unique<BallRenderer>(finer(ball), finer(scene)), scene);
  const Image<double> bent_picture = renderer.exact(ShutterPath{pose, pose, pose});
  const Image<double> plain = BallRenderer(ball, scene).exact(pose);
  double worst = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    worst = std::max(worst, std::abs(plain.data()[i] - bent_picture.data()[i]));
  }
  EXPECT_LT(worst, 0.05);  // grey levels; the formulas themselves are right to 0.01
}

TEST(SynthLens, AFoldIsRefused) {
  SynthRequest request;
  request.scene = bent_scene(-0.3, -0.3);
  EXPECT_THROW(request.validate(), InvalidArgument);
  request.scene = bent_scene(0.4, 0);
  EXPECT_THROW(request.validate(), InvalidArgument);
  request.scene = bent_scene(0.01, 0);
  EXPECT_NO_THROW(request.validate());
}

}  // namespace
}  // namespace impactdic::sim::speckle
