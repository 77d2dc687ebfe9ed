// What is painted on a sphere, and how it turns.
#include "sim/speckle/sphere/sphere.h"

#include <gtest/gtest.h>
#include <impactdic/synth.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "sim/speckle/motion.h"
#include "sim/speckle/orientation.h"
#include "sim/speckle/sphere/sphere_render.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

using sim::speckle::SpeckleSphere;

constexpr double kPi = std::numbers::pi;

// exp([r]x) by Rodrigues' formula, r in degrees.
Eigen::Matrix3d rodrigues(double rx, double ry, double rz) {
  const Eigen::Vector3d r = Eigen::Vector3d(rx, ry, rz) * kPi / 180;
  const double angle = r.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  Eigen::Matrix3d k;
  k << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  k /= angle;
  return Eigen::Matrix3d::Identity() + std::sin(angle) * k + (1 - std::cos(angle)) * k * k;
}

// A spin is the same turn from every frame to the next; it does not add its components.
TEST(SphereMotion, ASpinTurnsEveryFrameByTheSameVector) {
  ConstantMotion motion{{50, 50, 20}, 1, 0, 30};
  motion.start.ry_deg = 70;
  motion.spin_x_deg = 25;
  motion.spin_y_deg = -40;
  const auto poses = sim::speckle::constant_motion(motion, 12);
  for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
    const Eigen::Vector3d turn = sim::speckle::turn_between(poses[k], poses[k + 1]);
    EXPECT_NEAR((turn - Eigen::Vector3d(25, -40, 30)).norm(), 0, 1e-9);
    const Eigen::Matrix3d step = rodrigues(25, -40, 30);
    const Eigen::Matrix3d here = rodrigues(poses[k].rx_deg, poses[k].ry_deg, poses[k].angle_deg);
    const Eigen::Matrix3d next =
        rodrigues(poses[k + 1].rx_deg, poses[k + 1].ry_deg, poses[k + 1].angle_deg);
    EXPECT_NEAR((step * here - next).norm(), 0, 1e-9);
  }
}

class SpherePatterns : public ::testing::TestWithParam<sim::speckle::PatternSpec> {};

// The share of ink is the disc's; grain where the speckles do not touch.
TEST_P(SpherePatterns, HasTheDensityAndGrainOfTheDisc) {
  const sim::speckle::PatternSpec& spec = GetParam();
  const SpeckleSphere sphere = sim::speckle::paint_sphere(spec.name, 20, 60);
  const sim::speckle::InkMeasure ink = sim::speckle::measure_ink(sphere);
  EXPECT_NEAR(ink.density, spec.density, spec.mean_area_px > 100 ? 0.015 : 0.005);
  if (spec.mean_area_px > 0 && spec.mean_area_px < 100) {
    EXPECT_NEAR(ink.mean_area_px / spec.mean_area_px, 1, spec.density > 0.23 ? 0.13 : 0.05);
  }
  // Evenly: the caps' centres balance.
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double area = 0;
  for (const auto& cap : sphere.caps) {
    sum += cap.centre * cap.radius_px * cap.radius_px;
    area += cap.radius_px * cap.radius_px;
  }
  EXPECT_LT(sum.norm() / area, 3 / std::sqrt(static_cast<double>(sphere.caps.size())));
}

INSTANTIATE_TEST_SUITE_P(All, SpherePatterns, ::testing::ValuesIn(sim::speckle::pattern_specs()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(SphereMotion, ExposureIsTheMeanOverTheShutter) {
  SynthScene scene;
  scene.width = scene.height = 101;
  const sim::speckle::SphereRenderer renderer(sim::speckle::paint_sphere("b3", 3, 30), scene);
  ConstantMotion motion{{50.3, 49.8, 5}, 2.1, -1.7, 2.5};
  motion.spin_x_deg = -4;
  motion.spin_y_deg = 3;
  motion.start.rx_deg = 40;
  const auto poses = sim::speckle::constant_motion(motion, 3);
  const Image<double> blurred = renderer.exact(sim::speckle::shutter_path(poses, 1, 0.8));
  Image<double> mean(101, 101, 0);
  const int instants = 60;
  for (int i = 0; i < instants; ++i) {
    const BallPose at =
        sim::speckle::part_way(poses[0], poses[1], 1 + 0.8 * ((i + 0.5) / instants - 0.5));
    const Image<double> one = renderer.exact(at);
    for (std::size_t k = 0; k < mean.size(); ++k) mean.data()[k] += one.data()[k] / instants;
  }
  double worst = 0;
  for (std::size_t k = 0; k < mean.size(); ++k) {
    worst = std::max(worst, std::abs(mean.data()[k] - blurred.data()[k]));
  }
  EXPECT_LE(worst, 0.05);
}

// Row k holds the pose of frame k and the turn to frame k + 1, and reads back as the same motion.
TEST(SphereMotion, TheTruthHoldsPoseQuaternionAndTurn) {
  const testing::ScratchFolder folder;
  const auto file = folder / "truth.csv";
  ConstantMotion motion{{50, 60, 0}, 1, -2, 30};
  motion.spin_x_deg = 60;
  motion.spin_y_deg = -20;
  motion.start.ry_deg = 90;
  motion.dz_px = 5;
  const auto poses = sim::speckle::constant_motion(motion, 3);
  sim::speckle::write_sphere_truth_csv(file, poses, 40, 10, 1000);
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line,
            "frame,time_s,cx_px,cy_px,r_px,dx_px,dy_px,rot_deg,z_px,rx_deg,ry_deg,rz_deg,qw,qx,qy,"
            "qz,rot_x_deg,rot_y_deg");
  for (std::size_t k = 0; k < 3; ++k) {
    std::getline(in, line);
    std::vector<double> v;
    std::stringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) {
      v.push_back(field.empty() ? 0 : std::stod(field));
    }
    ASSERT_GE(v.size(), 16u);
    EXPECT_NEAR(v[4], 40 * 400 / (400 - 5.0 * static_cast<double>(k)), 1e-12);
    EXPECT_EQ(v[8], 5.0 * static_cast<double>(k));
    const Eigen::Matrix3d turned = rodrigues(v[9], v[10], v[11]);
    EXPECT_NEAR((Eigen::Quaterniond(v[12], v[13], v[14], v[15]).toRotationMatrix() - turned).norm(),
                0, 1e-12);
    EXPECT_GE(v[12], 0);
    if (k == 2) continue;
    ASSERT_EQ(v.size(), 18u);
    EXPECT_NEAR(v[16], 60, 1e-9);
    EXPECT_NEAR(v[17], -20, 1e-9);
    EXPECT_NEAR(v[7], 30, 1e-9);
  }
  const auto again = sim::speckle::read_motion_csv(file).poses;
  ASSERT_EQ(again.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(again[k].rx_deg, poses[k].rx_deg);
    EXPECT_EQ(again[k].angle_deg, poses[k].angle_deg);
    EXPECT_EQ(again[k].z_px, poses[k].z_px);
    EXPECT_EQ(again[k].cy_px, poses[k].cy_px);
  }
}

}  // namespace
}  // namespace impactdic
