// The sphere's renderer against brute force, and against what geometry demands.
#include "sim/speckle/sphere/sphere_render.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "sim/speckle/orientation.h"

namespace impactdic {
namespace {

using sim::speckle::SpeckleSphere;
using sim::speckle::SphereRenderer;

constexpr double kPi = std::numbers::pi;

BallPose pose_of(double x, double y, double rx, double ry, double rz) {
  BallPose pose{x, y, rz};
  pose.rx_deg = rx;
  pose.ry_deg = ry;
  return pose;
}

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

// The scene without lens, point by point: a ray from the eye meets an ellipsoid or misses it, and
// its point is inked or not. Shares nothing with the product's lines and arcs.
class Sharp {
 public:
  Sharp(const SpeckleSphere& sphere, const SynthScene& scene, const BallPose& pose)
      : sphere_(sphere), scene_(scene), pose_(pose) {
    turn_ = rodrigues(pose.rx_deg, pose.ry_deg, pose.angle_deg);
    const double a = pose.compression_axis_deg * kPi / 180;
    const Eigen::Vector3d n(std::cos(a), std::sin(a), 0);
    round_ = Eigen::Matrix3d::Identity() + (1 / (1 - pose.compression) - 1) * n * n.transpose();
  }

  double at(double x, double y) const {
    if (scene_.bar) {
      const double angle = scene_.bar->angle_deg * kPi / 180;
      const double n =
          (y - scene_.bar->y_px) * std::cos(angle) + (x - scene_.bar->x_px) * std::sin(angle);
      if (std::abs(n) <= scene_.bar->width_px / 2) return scene_.bar->level;
    }
    const std::optional<Eigen::Vector3d> hit = surface(x, y);
    if (!hit) return scene_.background;
    const double grey = inked(turn_.transpose() * *hit) ? scene_.ink : scene_.white;
    return grey * light(*hit / sphere_.radius_px);
  }

  // Mean over pixel and lens: a lattice turned by an irrational angle, so that no edge lies along
  // it, over +- 4.5 standard deviations. Its own error is about 0.02 grey levels.
  double pixel(int px, int py) const {
    const double sigma = scene_.psf_sigma_px, reach = 4.5 * sigma + 0.5, step = sigma / 60;
    const double c = std::cos(0.6180339887), s = std::sin(0.6180339887);
    const auto weight = [&](double u) {
      const double k = 1 / (sigma * std::sqrt(2.0));
      return std::erf((u + 0.5) * k) - std::erf((u - 0.5) * k);
    };
    near_.clear();  // caps that may be seen within the lens' reach of the pixel
    for (const auto& cap : sphere_.caps) {
      const Eigen::Vector3d there = round_.inverse() * (turn_ * cap.centre) * sphere_.radius_px;
      const double away = std::hypot(pose_.cx_px + there.x() - px, pose_.cy_px - there.y() - py);
      if (away < 2 * (reach + cap.radius_px) + (scene_.distance_radii > 0 ? 10 : 0)) {
        near_.push_back(&cap);
      }
    }
    double sum = 0, weights = 0;
    const int half = static_cast<int>(reach * 1.45 / step);
    for (int j = -half; j <= half; ++j) {
      for (int i = -half; i <= half; ++i) {
        const double u = step * (c * i - s * j), v = step * (s * i + c * j);
        if (std::abs(u) > reach || std::abs(v) > reach) continue;
        const double w = weight(u) * weight(v);
        sum += w * at(px + u, py + v);
        weights += w;
      }
    }
    return sum / weights;
  }

 private:
  // About the ball's centre, in the space where it is round; camera axes.
  std::optional<Eigen::Vector3d> surface(double x, double y) const {
    const double x0 = (scene_.width - 1) / 2.0, y0 = (scene_.height - 1) / 2.0;
    Eigen::Vector3d eye, ray;
    if (scene_.distance_radii == 0) {
      eye = {x - pose_.cx_px, pose_.cy_px - y, 1e4};
      ray = {0, 0, -1};
    } else {
      const double d = scene_.distance_radii * sphere_.radius_px, depth = d - pose_.z_px;
      eye = {-(pose_.cx_px - x0) * depth / d, (pose_.cy_px - y0) * depth / d, depth};
      ray = Eigen::Vector3d(x - x0, y0 - y, -d);
    }
    eye = round_ * eye;
    ray = (round_ * ray).normalized();
    const double middle = -eye.dot(ray), away = (eye + middle * ray).norm();
    if (away >= sphere_.radius_px) return std::nullopt;
    return eye + (middle - std::sqrt(sphere_.radius_px * sphere_.radius_px - away * away)) * ray;
  }
  bool inked(const Eigen::Vector3d& p) const {
    const double r = sphere_.radius_px;
    for (const auto* cap : near_) {
      // Distance from the cap's axis.
      if (p.dot(cap->centre) > 0 && p.cross(cap->centre).squaredNorm() < square(cap->radius_px)) {
        return true;
      }
    }
    for (const auto& strip : sphere_.strips) {
      const double aside = std::asin(p.dot(strip.middle.cross(strip.along)) / r) * r;
      const double ahead = std::atan2(p.dot(strip.along), p.dot(strip.middle)) * r;
      if (std::abs(aside) < strip.width_px / 2 && std::abs(ahead) < strip.length_px / 2) {
        return true;
      }
    }
    return false;
  }
  double light(const Eigen::Vector3d& n) const {
    const double a = scene_.lamp_deg * kPi / 180, e = scene_.lamp_elevation_deg * kPi / 180;
    const Eigen::Vector3d lamp(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
    return 1 - scene_.lamp_share + scene_.lamp_share * std::max(0.0, n.dot(lamp));
  }

  static double square(double value) { return value * value; }

  const SpeckleSphere& sphere_;
  const SynthScene& scene_;
  BallPose pose_;
  mutable std::vector<const sim::speckle::InkCap*> near_;
  Eigen::Matrix3d turn_, round_;
};

double worst_pixel(const SpeckleSphere& sphere, const SynthScene& scene, const BallPose& pose,
                   int count) {
  const Image<double> picture = SphereRenderer(sphere, scene).exact(pose);
  const Sharp sharp(sphere, scene, pose);
  double worst = 0;
  for (int i = 0; i < count; ++i) {
    // Sunflower spiral, out to just beyond the rim; each third pixel on the rim itself.
    const double away =
        i % 3 == 0 ? sphere.radius_px : (sphere.radius_px + 2) * std::sqrt((i + 0.5) / count);
    const int x = static_cast<int>(std::lround(pose.cx_px + away * std::cos(2.39996 * i)));
    const int y = static_cast<int>(std::lround(pose.cy_px + away * std::sin(2.39996 * i)));
    const double error = std::abs(picture(x, y) - sharp.pixel(x, y));
    worst = std::max(worst, error);
  }
  return worst;
}

constexpr double kPixelBound = 0.1;  // grey levels: what sphere_render.h promises

TEST(SphereRender, EqualsBruteForce) {
  const SpeckleSphere sphere = sim::speckle::paint_sphere("e1", 5, 20);
  SynthScene scene;
  scene.width = scene.height = 61;
  for (const double sigma : {0.3, 0.6, 1.0}) {
    scene.psf_sigma_px = sigma;
    EXPECT_LE(worst_pixel(sphere, scene, pose_of(30.3, 29.6, 40, -70, 33), 12), kPixelBound)
        << sigma;
  }
}

TEST(SphereRender, EqualsBruteForceWithLampBarStripsPerspectiveAndCompression) {
  SpeckleSphere sphere = sim::speckle::paint_sphere("f2", 6, 20);
  SynthScene scene;
  scene.width = scene.height = 61;
  scene.lamp_share = 0.6;
  scene.lamp_deg = 100;
  scene.lamp_elevation_deg = 25;
  scene.distance_radii = 4;
  BallPose pose = pose_of(34.71, 27.13, 100, 20, -71);
  pose.compression = 0.1;
  pose.compression_axis_deg = 75;
  pose.z_px = 9;
  scene.bar = sim::speckle::bar_hiding(0.3, pose, 20);
  scene.bar->angle_deg = 8;
  EXPECT_LE(worst_pixel(sphere, scene, pose, 14), kPixelBound);
}

// Light above the background: its sum and centroid.
struct Light {
  double sum = 0, x = 0, y = 0;
};
Light light_of(const Image<double>& picture, double background) {
  Light light;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const double level = picture(x, y) - background;
      light.sum += level;
      light.x += level * x;
      light.y += level * y;
    }
  }
  light.x /= light.sum;
  light.y /= light.sum;
  return light;
}

SynthScene small_scene() {
  SynthScene scene;
  scene.width = scene.height = 160;
  return scene;
}

// What a lone spot takes from the picture of a plain ball.
Light spot_of(const Eigen::Vector3d& centre, double radius_px, const BallPose& pose,
              const SynthScene& scene) {
  const SpeckleSphere plain{60, {}, {}}, spotted{60, {{centre.normalized(), radius_px}}, {}};
  Image<double> lost = SphereRenderer(plain, scene).exact(pose);
  const Image<double> with = SphereRenderer(spotted, scene).exact(pose);
  for (std::size_t i = 0; i < lost.size(); ++i) lost.data()[i] -= with.data()[i];
  return light_of(lost, 0);
}

TEST(SphereRender, LightOfAPlainSphereHasItsAreaAndCentre) {
  for (const double compression : {0.0, 0.1}) {
    BallPose pose = pose_of(79.37, 80.61, 12, 50, 7);
    pose.compression = compression;
    const Light light =
        light_of(SphereRenderer(SpeckleSphere{60, {}, {}}, small_scene()).exact(pose), 30);
    EXPECT_NEAR(light.sum / 170 / (kPi * 3600 * (1 - compression)), 1, 1e-6);
    EXPECT_NEAR(light.x, 79.37, 1e-5);
    EXPECT_NEAR(light.y, 80.61, 1e-5);
  }
}

// The picture of a circle on a sphere is an ellipse; of parallel rays its centre is that of the
// circle, and its area is foreshortened by the cosine.
TEST(SphereRender, ALoneSpotIsSeenWhereTheGeometrySays) {
  const double r = 4, depth = std::sqrt(60.0 * 60 - r * r);
  const Eigen::Vector3d on_ball = Eigen::Vector3d(0.3, -0.5, 0.8).normalized();
  for (const auto& [rx, ry, rz] : {std::array{0.0, 0.0, 0.0}, std::array{20.0, -35.0, 10.0},
                                   std::array{-40.0, 25.0, 120.0}, std::array{5.0, 60.0, -30.0}}) {
    const BallPose pose = pose_of(79.37, 80.61, rx, ry, rz);
    const Eigen::Vector3d there = rodrigues(rx, ry, rz) * on_ball;
    ASSERT_GT(there.z(), 0.2);  // wholly seen
    const Light spot = spot_of(on_ball, r, pose, small_scene());
    EXPECT_NEAR(spot.x, 79.37 + depth * there.x(), 1e-4);
    EXPECT_NEAR(spot.y, 80.61 - depth * there.y(), 1e-4);
    EXPECT_NEAR(spot.sum / 160 / (kPi * r * r * there.z()), 1, 1e-4);
  }
}

TEST(SphereRender, PositiveTurnsAreRightHandedAboutRightUpAndTowardsTheCamera) {
  const Eigen::Vector3d to_camera(0, 0, 1);
  const Light about_x = spot_of(to_camera, 4, pose_of(80, 80, 20, 0, 0), small_scene());
  EXPECT_NEAR(about_x.x, 80, 1e-4);
  EXPECT_GT(about_x.y, 95);  // Y x Z: down on the screen
  const Light about_y = spot_of(to_camera, 4, pose_of(80, 80, 0, 20, 0), small_scene());
  EXPECT_GT(about_y.x, 95);
  EXPECT_NEAR(about_y.y, 80, 1e-4);
  const Light about_z = spot_of({0.5, 0, 1}, 4, pose_of(80, 80, 0, 0, 90), small_scene());
  EXPECT_NEAR(about_z.x, 80, 1e-4);
  EXPECT_LT(about_z.y, 65);  // counter-clockwise on the screen
}

TEST(SphereRender, TheFarSideComesIntoView) {
  const Eigen::Vector3d behind(0, 0, -1);
  const SpeckleSphere sphere{60, {{behind, 6}}, {}};
  const SphereRenderer renderer(sphere, small_scene());
  EXPECT_NEAR(renderer.exact(pose_of(80, 80, 0, 0, 0))(80, 80), 200, 1e-3);
  EXPECT_NEAR(renderer.exact(pose_of(80, 80, 0, 180, 0))(80, 80), 40, 1e-3);
}

// Lines run along the rows only, so that a quarter turn is another calculation of the same picture.
TEST(SphereRender, AQuarterTurnAboutTheLineOfSightTurnsThePicture) {
  const SpeckleSphere sphere = sim::speckle::paint_sphere("f2", 3, 40);
  SynthScene scene;
  scene.width = scene.height = 101;
  scene.limb_darkening = 0.6;
  const SphereRenderer renderer(sphere, scene);
  BallPose pose = pose_of(50, 50, 70, -40, 15), turned = pose;
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitZ()));
  sim::speckle::set_orientation(turned, quarter * sim::speckle::orientation_of(pose));
  const Image<double> a = renderer.exact(pose), b = renderer.exact(turned);
  double worst = 0, square = 0;
  for (int y = 0; y < 101; ++y) {
    for (int x = 0; x < 101; ++x) {
      const double error = a(x, y) - b(y, 100 - x);
      worst = std::max(worst, std::abs(error));
      square += error * error;
    }
  }
  EXPECT_LT(worst, 0.4);  // at the rim
  EXPECT_LT(std::sqrt(square / (kPi * 1600)), 0.03);
}

TEST(SphereRender, WholePixelMotionMovesThePictureExactly) {
  const SphereRenderer renderer(sim::speckle::paint_sphere("e2", 3, 40),
                                {.width = 128, .height = 128});
  const Image<double> here = renderer.exact(pose_of(60.3, 61.8, 17, 5, 2));
  const Image<double> there = renderer.exact(pose_of(65.3, 58.8, 17, 5, 2));
  double worst = 0;
  for (int y = 10; y < 118; ++y) {
    for (int x = 10; x < 118; ++x) {
      worst = std::max(worst, std::abs(here(x, y) - there(x + 5, y - 3)));
    }
  }
  EXPECT_LT(worst, 2e-3);  // sums of floats at positions that differ by rounding
}

// Mean of a Lambert sphere lit from the camera is 2/3 of its full light, and of one with limb
// darkening u 1 - u/3.
TEST(SphereRender, ALitSphereGivesTheLightThatLambertSays) {
  SynthScene scene = small_scene();
  scene.background = 0;
  const BallPose pose = pose_of(79.37, 80.61, 0, 0, 0);
  const auto light = [&] {
    return light_of(SphereRenderer(SpeckleSphere{60, {}, {}}, scene).exact(pose), 0).sum / 200 /
           (kPi * 3600);
  };
  scene.limb_darkening = 0.9;
  EXPECT_NEAR(light(), 1 - 0.3, 1e-5);
  scene.limb_darkening = 0;
  scene.lamp_share = 0.7;
  scene.lamp_elevation_deg = 90;
  EXPECT_NEAR(light(), 0.3 + 0.7 * 2 / 3, 1e-5);
  // From the side half of the disc is lit: its mean cosine over the whole disc is 2/(3 pi).
  scene.lamp_elevation_deg = 0;
  scene.lamp_deg = 0;
  EXPECT_NEAR(light(), 0.3 + 0.7 * 2 / (3 * kPi), 1e-5);
  const Image<double> lit =
      SphereRenderer(SpeckleSphere{60, {}, {}}, scene).exact(pose_of(80, 80, 0, 0, 0));
  EXPECT_NEAR(lit(110, 80), 200 * (0.3 + 0.7 * 0.5), 0.05);  // the lamp is on the right
  EXPECT_NEAR(lit(50, 80), 200 * 0.3, 0.05);
}

TEST(SphereRender, ACameraAtADistanceSeesLessOfALargerOutline) {
  SynthScene scene = small_scene();
  scene.distance_radii = 5;
  const double d = 300, middle = 79.5;
  const Light light = light_of(
      SphereRenderer(SpeckleSphere{60, {}, {}}, scene).exact(pose_of(middle, middle, 0, 0, 0)), 30);
  EXPECT_NEAR(light.sum / 170 / (kPi * 3600 / (1 - 1.0 / 25)), 1, 1e-6);
  // A spot small enough for its centroid to be its middle: f (X, -Y) / (D - Z), once in the middle
  // and once off the axis and nearer.
  const Eigen::Vector3d at = Eigen::Vector3d(0.4, 0.3, 0.7).normalized() * 60;
  const Light spot = spot_of(at, 0.5, pose_of(middle, middle, 0, 0, 0), scene);
  EXPECT_NEAR(spot.x, middle + d * at.x() / (d - at.z()), 0.002);
  EXPECT_NEAR(spot.y, middle - d * at.y() / (d - at.z()), 0.002);
  BallPose aside = pose_of(60, 90, 0, 0, 0);
  aside.z_px = 20;
  const double x = (60 - middle) * 280 / d, y = -(90 - middle) * 280 / d;
  const Light there = spot_of(at, 0.5, aside, scene);
  EXPECT_NEAR(there.x, middle + d * (x + at.x()) / (280 - at.z()), 0.002);
  EXPECT_NEAR(there.y, middle - d * (y + at.y()) / (280 - at.z()), 0.002);
  aside.z_px = 250;
  EXPECT_THROW(SphereRenderer(SpeckleSphere{60, {}, {}}, scene).exact(aside), InvalidArgument);
}

TEST(SphereRender, BarHidesTheStatedShareOfTheBall) {
  const BallPose pose = pose_of(79.4, 80.2, 0, 0, 0);
  for (const double angle : {0.0, 30.0, 90.0}) {
    SynthScene scene = small_scene();
    scene.bar = sim::speckle::bar_hiding(0.3, pose, 60, angle);
    scene.bar->level = scene.background;  // so that only the ball is bright
    const Light light = light_of(SphereRenderer(SpeckleSphere{60, {}, {}}, scene).exact(pose), 30);
    EXPECT_NEAR(light.sum / 170 / (kPi * 3600), 0.7, 1e-4) << angle;
  }
}

TEST(SphereRender, FramesDoNotDependOnTheNumberOfThreads) {
  SynthScene scene;
  scene.width = scene.height = 120;
  scene.noise_sigma = 2;
  const SphereRenderer renderer(sim::speckle::paint_sphere("f1", 4, 40), scene);
  const auto frame_with = [&](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    Frame frame;
    renderer.render(pose_of(59.5, 61.2, 10, 20, 30), 7, frame);
    return std::vector<std::uint8_t>(frame.u8.data(), frame.u8.data() + frame.u8.size());
  };
  EXPECT_EQ(frame_with(1), frame_with(4));
}

}  // namespace
}  // namespace impactdic
