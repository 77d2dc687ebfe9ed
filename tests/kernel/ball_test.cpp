// rigid.cl against its double-precision reference, and what it says where it cannot measure.
#include "host/dic/reference/ball.h"

#include <gtest/gtest.h>
#include <impactdic/units.h>

#include <cmath>

#include "host/sphere/picture_blur.h"
#include "tests/support/engine.h"
#include "tests/support/speckle_frames.h"
#include "tests/support/sphere/sphere_pictures.h"

namespace impactdic {
namespace {

using testing::pose;
using testing::shared_engine;

constexpr int kWidth = 157, kHeight = 150;
constexpr double kRadiusPx = 60;

struct Case {
  int degree;
  dic::BallModel model;
  bool robust, bar;
  double x_px;  // of the ball in the first frame: 40 hides a part beyond the picture's edge
  std::optional<dic::Tiling> tiling = {};  // other than this device's own
  double distance_radii = 0;               // 0: parallel rays
  double compression = 0;                  // along y in the first picture, and half as much more
  bool lit = false;                        // by a lamp that leaves a side in shadow
};
constexpr auto kRigid = dic::BallModel::kRigid, kAffine = dic::BallModel::kAffine,
               kSphere = dic::BallModel::kSphere;
class BallKernel : public ::testing::TestWithParam<Case> {};

TEST_P(BallKernel, GivesWhatTheReferenceGives) {
  const Case param = GetParam();
  opencl::Engine& engine = shared_engine();
  SynthScene scene;
  scene.width = kWidth;
  scene.height = kHeight;
  scene.noise_sigma = 2;
  if (param.bar) scene.bar = sim::speckle::bar_hiding(0.25, pose(param.x_px, 74, 0), kRadiusPx);
  BallPose first = pose(param.x_px, 74.4, 10), second = pose(param.x_px + 1.37, 73.79, 13);
  if (param.model == dic::BallModel::kAffine) second.compression = 0.01;
  const auto pictures =
      testing::render_frames(testing::quick_ball(6, kRadiusPx), scene, {first, second});
  dic::BallOptions options;
  options.spline_degree = param.degree;
  options.model = param.model;
  options.robust = param.robust;
  dic::DeviceFrames frames(engine, 3);
  dic::BallRegistration registration(engine, options, param.tiling);
  for (int k = 0; k < 2; ++k) {
    frames.set(2 - k, pictures[static_cast<std::size_t>(k)]);
  }
  BallTask task{};
  task.first = 2;
  task.second = 1;
  task.cx = static_cast<float>(first.cx_px);
  task.cy = static_cast<float>(first.cy_px);
  task.radius = static_cast<float>(kRadiusPx - dic::kRimMarginPx);
  task.guess_dx = 1;
  task.guess_dy = -1;
  task.guess_rot_rad = 0.04f;
  BallTask smaller = task;
  smaller.radius = 33.3f;
  const std::vector<BallTask> tasks = {task, smaller, task};
  const auto motions = registration.measure(frames, tasks);
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    const BallMotion want = dic::ball_reference(pictures[0], pictures[1], tasks[k], options);
    const BallMotion& got = motions[k];
    ASSERT_EQ(want.status, static_cast<idic_int>(WindowStatus::kOk));
    ASSERT_EQ(got.status, static_cast<idic_int>(WindowStatus::kOk));
    // Single precision and the histogram's median: far below the noise (1e-3 px).
    EXPECT_NEAR(got.dx, want.dx, 1e-4);
    EXPECT_NEAR(got.dy, want.dy, 1e-4);
    EXPECT_NEAR(got.rot_rad, want.rot_rad, 1e-4 / task.radius);
    EXPECT_NEAR(got.exx, want.exx, 1e-4 / task.radius);
    EXPECT_NEAR(got.exy, want.exy, 1e-4 / task.radius);
    EXPECT_NEAR(got.eyy, want.eyy, 1e-4 / task.radius);
    EXPECT_NEAR(got.correlation, want.correlation, 1e-5);
    EXPECT_NEAR(got.residual, want.residual, 0.003 * want.residual);
    EXPECT_NEAR(got.used, want.used, 0.002);
    EXPECT_GT(got.dx_sd, 0);
  }
  EXPECT_EQ(motions[0].dx, motions[2].dx);
}
INSTANTIATE_TEST_SUITE_P(
    Cases, BallKernel,
    ::testing::Values(Case{7, kRigid, true, false, 76.3}, Case{7, kRigid, true, true, 76.3},
                      Case{5, kRigid, false, false, 76.3}, Case{3, kAffine, true, false, 76.3},
                      Case{7, kAffine, true, true, 76.3}, Case{7, kRigid, true, false, 40.2},
                      Case{7, kRigid, true, true, 40.2, dic::Tiling{1, 128}},
                      Case{5, kAffine, true, true, 76.3, dic::Tiling{4, 2}}));

class SphereKernel : public ::testing::TestWithParam<Case> {};

// The rotation vector of a turn of `angle_deg` about an axis.
Eigen::Vector3d turn_about(double x, double y, double z, double angle_deg) {
  return Eigen::Vector3d(x, y, z).normalized() * angle_deg * kRadPerDeg;
}

// Has both poses seen as the case says, from far to the right of and below the optical axis.
BallSight see(const Case& param, testing::SpherePose& first, testing::SpherePose& second) {
  BallSight sight{};
  if (param.distance_radii > 0) {
    const double by_distance = 1 / (param.distance_radii * kRadiusPx);
    for (testing::SpherePose* pose : {&first, &second}) {
      pose->by_distance = by_distance;
      pose->aside_x = by_distance * (pose->cx_px + 150);
      pose->aside_y = by_distance * (pose->cy_px + 90);
    }
    sight.by_distance = static_cast<float>(by_distance);
    sight.first_x = sight.second_x = static_cast<float>(first.aside_x);
    sight.first_y = sight.second_y = static_cast<float>(first.aside_y);
  }
  first.compression = param.compression;
  second.compression = 1.5 * param.compression;
  sight.first[2] = static_cast<float>(-first.compression);
  sight.second[2] = static_cast<float>(-second.compression);
  return sight;
}

// A lamp that leaves the ball's left side in shadow.
constexpr BallLight kLamp = {0.2F, {0.7F, -0.2F, 0.3F}, 0.02F};

// What it makes of a picture of a round ball seen by parallel rays.
Frame lit_by_lamp(Frame picture, const testing::SpherePose& pose) {
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const double nx = (x - pose.cx_px) / kRadiusPx, ny = (y - pose.cy_px) / kRadiusPx;
      const double nz = std::sqrt(std::max(0.0, 1 - nx * nx - ny * ny));
      const double facing = kLamp.lamp[0] * nx + kLamp.lamp[1] * ny + kLamp.lamp[2] * nz;
      const double level = kLamp.ambient + std::max(0.0, facing);
      picture.u8(x, y) = static_cast<std::uint8_t>(std::lround(picture.u8(x, y) * level));
    }
  }
  return picture;
}

TEST_P(SphereKernel, GivesWhatTheReferenceGives) {
  const Case param = GetParam();
  const testing::SpherePictures sphere(6, kRadiusPx);
  const Eigen::Vector3d turn = turn_about(2, -3, 1.5, 5);
  testing::SpherePose first{param.x_px, 74.4, dic::quaternion_of({0.3, -1, 2})};
  testing::SpherePose second{param.x_px + 1.37, 73.79, dic::quaternion_of(turn) * first.turn};
  const BallSight sight = see(param, first, second);
  Frame pictures[] = {sphere.render(first, kWidth, kHeight, 2, 1),
                      sphere.render(second, kWidth, kHeight, 2, 2)};
  if (param.lit) {
    pictures[0] = lit_by_lamp(std::move(pictures[0]), first);
    pictures[1] = lit_by_lamp(std::move(pictures[1]), second);
  }
  dic::BallOptions options;
  options.lit = param.lit;
  options.spline_degree = param.degree;
  options.model = param.model;
  options.robust = param.robust;
  dic::DeviceFrames frames(shared_engine(), 2);
  for (int k : {0, 1}) frames.set(k, pictures[k]);
  BallTask task{};
  task.second = 1;
  task.cx = static_cast<float>(first.cx_px);
  task.cy = static_cast<float>(first.cy_px);
  task.radius = static_cast<float>(kRadiusPx - dic::kRimMarginPx);
  task.ball_radius = static_cast<float>(kRadiusPx);
  task.blur = static_cast<float>(sphere::kUsualBlur_px2);
  task.sight = sight;
  task.light = kLamp;
  task.guess_dx = 1.2F;
  task.guess_dy = -0.8F;
  task.guess_rot_x_rad = static_cast<float>(turn.x() + 0.008);
  task.guess_rot_y_rad = static_cast<float>(turn.y() - 0.009);
  task.guess_rot_rad = static_cast<float>(turn.z() + 0.01);
  const BallMotion got =
      dic::BallRegistration(shared_engine(), options, param.tiling).measure(frames, {&task, 1})[0];
  const BallMotion want = dic::ball_reference(pictures[0], pictures[1], task, options);
  ASSERT_EQ(want.status, static_cast<idic_int>(WindowStatus::kOk));
  ASSERT_EQ(got.status, static_cast<idic_int>(WindowStatus::kOk));
  EXPECT_NEAR(got.dx, want.dx, 3e-4);
  EXPECT_NEAR(got.dy, want.dy, 3e-4);
  EXPECT_NEAR(got.rot_x_rad, want.rot_x_rad, 3e-4 / kRadiusPx);
  EXPECT_NEAR(got.rot_y_rad, want.rot_y_rad, 3e-4 / kRadiusPx);
  EXPECT_NEAR(got.rot_rad, want.rot_rad, 1e-4 / kRadiusPx);
  EXPECT_NEAR(got.correlation, want.correlation, 1e-5);
  EXPECT_NEAR(got.residual, want.residual, 0.003 * want.residual);
  EXPECT_NEAR(got.used, want.used, 0.002);
  // And what is measured is the motion.
  EXPECT_NEAR(got.dx, 1.37, 5 * got.dx_sd);
  EXPECT_NEAR(got.dy, -0.61, 5 * got.dy_sd);
  const double sd_x = std::sqrt(got.covariance[5]), sd_y = std::sqrt(got.covariance[9]);
  EXPECT_NEAR(got.rot_x_rad, turn.x(), 5 * sd_x);
  EXPECT_NEAR(got.rot_y_rad, turn.y(), 5 * sd_y);
  EXPECT_NEAR(got.rot_rad, turn.z(), 5 * got.rot_sd_rad);
  EXPECT_LT(sd_x, param.lit ? 5e-4 : 2e-4);  // in shadow little is told
}
INSTANTIATE_TEST_SUITE_P(Cases, SphereKernel,
                         ::testing::Values(Case{7, kSphere, true, false, 76.3},
                                           Case{5, kSphere, false, false, 76.3},
                                           Case{7, kSphere, true, false, 40.2},
                                           Case{7, kSphere, true, false, 76.3, dic::Tiling{1, 128}},
                                           Case{7, kSphere, true, false, 76.3, dic::Tiling{4, 2}},
                                           Case{7, kSphere, true, false, 76.3, {}, 12},
                                           Case{7, kSphere, true, false, 76.3, {}, 0, 0.08},
                                           Case{7, kSphere, true, false, 76.3, {}, 0, 0, true},
                                           Case{7, kSphere, true, false, 76.3, {}, 12, 0, true},
                                           Case{7, kSphere, true, false, 76.3, {}, 12, 0.08}));

// A pair of pictures of a turned ball whose radius is guessed half a pixel too small; what is told
// of the motion is right.
struct GuessedRadius {
  GuessedRadius(std::uint32_t seed, double turn_deg, double nearness = 0)
      : turn(turn_about(1, 2, 0.5, turn_deg)) {
    const testing::SpherePictures sphere(seed, kRadiusPx);
    testing::SpherePose first{76.3, 74.4, dic::quaternion_of({1, 0.4, -2})};
    testing::SpherePose second{77.1, 74.0, dic::quaternion_of(turn) * first.turn};
    for (testing::SpherePose* pose : {&first, &second}) {
      pose->by_distance = nearness / kRadiusPx;
      pose->aside_x = pose->by_distance * (pose->cx_px - kAxisX);
      pose->aside_y = pose->by_distance * (pose->cy_px - kAxisY);
    }
    frames.set(0, sphere.render(first, kWidth, kHeight, 2, 1));
    frames.set(1, sphere.render(second, kWidth, kHeight, 2, 2));
    task.second = 1;
    task.cx = static_cast<float>(first.cx_px);
    task.cy = static_cast<float>(first.cy_px);
    task.radius = static_cast<float>(kRadiusPx - 5);
    task.ball_radius = static_cast<float>(kRadiusPx - 0.5);
    task.blur = static_cast<float>(sphere::kUsualBlur_px2);
    task.guess_dx = 0.8F;
    task.guess_dy = -0.4F;
    task.guess_rot_x_rad = static_cast<float>(turn.x());
    task.guess_rot_y_rad = static_cast<float>(turn.y());
    task.guess_rot_rad = static_cast<float>(turn.z());
  }
  // Where the search for the distance begins.
  void guess_nearness(double nearness) {
    const float start = task.sight.by_distance = static_cast<float>(nearness / kRadiusPx);
    task.sight.first_x = task.sight.second_x = start * (task.cx - static_cast<float>(kAxisX));
    task.sight.first_y = task.sight.second_y = start * (task.cy - static_cast<float>(kAxisY));
  }
  BallMotion measure(dic::BallModel model, bool free_centre = false) {
    dic::BallOptions options;
    options.model = model;
    options.free_centre = free_centre;
    return dic::BallRegistration(shared_engine(), options).measure(frames, {&task, 1})[0];
  }

  const Eigen::Vector3d turn;
  dic::DeviceFrames frames{shared_engine(), 2};
  BallTask task{};

  static constexpr double kAxisX = 20, kAxisY = 100;  // px, of the optical axis
};

// The depth of what turns tells the radius.
TEST(SphereKernel, FindsTheRadiusAlongWithTheTurn) {
  GuessedRadius pair(8, 8);
  const BallMotion got = pair.measure(dic::BallModel::kSphereAndRadius);
  ASSERT_EQ(got.status, static_cast<idic_int>(WindowStatus::kOk));
  EXPECT_LT(got.ball_radius_sd, 0.1);
  EXPECT_NEAR(got.ball_radius, kRadiusPx, 4 * got.ball_radius_sd);
  EXPECT_NEAR(got.rot_y_rad, pair.turn.y(), 4 * std::sqrt(got.covariance[9]));
}

// The depth of what turns tells the radius, and what is nearer the distance.
TEST(SphereKernel, FindsRadiusAndDistanceAlongWithTheTurn) {
  constexpr double kNearness = 0.05;
  constexpr auto kModel = dic::BallModel::kSphereRadiusAndDistance;
  GuessedRadius pair(9, 20, kNearness);
  // It must begin somewhere.
  EXPECT_THROW(pair.measure(kModel), InvalidArgument);
  pair.guess_nearness(0.02);
  const BallMotion got = pair.measure(kModel);
  ASSERT_EQ(got.status, static_cast<idic_int>(WindowStatus::kOk));
  const double nearness = got.by_distance * kRadiusPx, sd = got.by_distance_sd * kRadiusPx;
  EXPECT_LT(sd, 0.001);
  EXPECT_NEAR(nearness, kNearness, 5 * sd);
  EXPECT_NEAR(got.ball_radius, kRadiusPx, 5 * got.ball_radius_sd);
  EXPECT_NEAR(got.dx, 0.8, 5 * got.dx_sd);
  EXPECT_NEAR(got.rot_y_rad, pair.turn.y(), 5 * std::sqrt(got.covariance[9]));
}

// A point beside the centre that was told lies at another depth, which a turn shows.
TEST(SphereKernel, FindsTheCentreAlongWithTheTurn) {
  constexpr auto kModel = dic::BallModel::kSphereAndRadius;
  GuessedRadius pair(11, 20);
  const float cx = pair.task.cx, cy = pair.task.cy;
  pair.task.cx += 0.12F;
  pair.task.cy -= 0.09F;
  EXPECT_THROW(pair.measure(kModel, true), InvalidArgument);  // nothing is said of the centre
  pair.task.centre_sd = 0.1F;
  const BallMotion got = pair.measure(kModel, true);
  ASSERT_EQ(got.status, static_cast<idic_int>(WindowStatus::kOk));
  EXPECT_LT(std::max(got.cx_sd, got.cy_sd), 0.03);
  EXPECT_NEAR(got.cx, cx, 4 * got.cx_sd);
  EXPECT_NEAR(got.cy, cy, 4 * got.cy_sd);
  EXPECT_NEAR(got.ball_radius, kRadiusPx, 4 * got.ball_radius_sd);
  EXPECT_NEAR(got.rot_y_rad, pair.turn.y(), 4 * std::sqrt(got.covariance[9]));
  // What was told counts: hardly free, it stays.
  pair.task.centre_sd = 1e-4F;
  EXPECT_NEAR(pair.measure(kModel, true).cx, pair.task.cx, 0.005);
}

TEST(BallKernel, SaysWhyItCannotMeasure) {
  opencl::Engine& engine = shared_engine();
  SynthScene scene;
  scene.width = kWidth;
  scene.height = kHeight;
  const auto speckled =
      testing::render_frames(testing::quick_ball(6, kRadiusPx), scene, {pose(76, 74, 0)});
  const auto other =
      testing::render_frames(testing::quick_ball(7, kRadiusPx), scene, {pose(76, 74, 0)});
  Frame flat;
  flat.reset(kWidth, kHeight, 8);
  std::fill_n(flat.u8.data(), flat.u8.size(), std::uint8_t{90});
  dic::DeviceFrames frames(engine, 3);
  dic::BallRegistration registration(engine, {});
  const Frame* pictures[] = {&speckled[0], &other[0], &flat};
  for (int k = 0; k < 3; ++k) {
    frames.set(k, *pictures[k]);
  }
  const auto task = [](int first, int second, float x) {
    return BallTask{first, second, x, 74, 56, 0, 0, 0, 0, 0, 0};
  };
  const auto motions = registration.measure(
      frames, std::vector{task(2, 0, 76), task(0, 1, 76), task(0, 0, -500), task(0, 0, 76)});
  EXPECT_EQ(motions[0].status, static_cast<idic_int>(WindowStatus::kNoTexture));
  EXPECT_NE(motions[1].status, static_cast<idic_int>(WindowStatus::kOk));
  EXPECT_EQ(motions[2].status, static_cast<idic_int>(WindowStatus::kOutOfView));
  EXPECT_EQ(motions[3].status, static_cast<idic_int>(WindowStatus::kOk));
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(std::isnan(motions[static_cast<std::size_t>(k)].dx));
  EXPECT_NEAR(motions[3].dx, 0, 1e-6);
  EXPECT_THROW(registration.measure(frames, std::vector{task(0, 3, 76)}), InvalidArgument);
}

}  // namespace
}  // namespace impactdic
