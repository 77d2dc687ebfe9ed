// Clips of a ball as cameras show it, with exactly known poses: lamps, dark sides, backgrounds with
// a texture, obstacles, blur, over-exposure.
#pragma once

#include <impactdic/synth.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/speckle/motion.h"
#include "sim/speckle/render_parts.h"
#include "sim/speckle/sphere/sphere_render.h"

namespace impactdic::testing {

enum class Backdrop { kEven, kWood, kTiles, kSlope };

// Grey levels are of 255.
struct LightScene {
  const char* name = "";
  bool sphere = false;
  const char* pattern = "e1";
  double radius_px = 115;
  double shading = 0;  // of a disc, and of a sphere: falls linearly across
  double lamp_share = 0, lamp_elevation_deg = 0, limb_darkening = 0;
  double gain = 1;  // of all light; what exceeds 255 is cut off
  double noise = 2, blur_px = 0.6, exposure = 0;
  double hidden = 0, bar_angle_deg = 0;  // share of the ball behind a bar, mid-clip
  double bar_level = 90;
  double compression = 0;
  bool contact = false;  // compressed in the middle third of the clip alone, else in all of it
  Backdrop backdrop = Backdrop::kEven;
  double dx_px = 0.73, dy_px = -0.41, spin_x_deg = 0.4, spin_y_deg = 0.6, rotation_deg = 1.1;
  bool enters = false;  // from outside the picture, and leaves it
  int wider_px = 0;     // than a picture that holds the ball with something about it
};

// Level of a background at a point; it is smooth enough that the lens need not blur it.
inline double backdrop_level(Backdrop kind, std::uint64_t seed, double x, double y) {
  const double a = static_cast<double>(seed);
  if (kind == Backdrop::kWood) {
    const double v = y + 4 * std::sin(x / 37 + a) + 0.05 * x;
    return 62 + 18 * std::sin(v / 5.3 + a) + 11 * std::sin(v / 2.1 + 2 * a) +
           8 * std::sin(x / 61 + 3 * a);
  }
  if (kind == Backdrop::kTiles) {
    constexpr double kSide = 43, kJoint = 2;
    const auto joint = [](double at) {
      const double off = at - kSide * std::round(at / kSide);
      return std::exp(-off * off / (2 * kJoint * kJoint));
    };
    const double u = x + 7 * a, v = y + 11 * a;
    const double joints = std::max(joint(u), joint(v));
    return 85 - 60 * joints + 4 * std::sin(u / 19) * std::sin(v / 23);
  }
  if (kind == Backdrop::kSlope) return 45 + 0.27 * x;  // a wall lit from one side
  return 30;
}

class LightClip {
 public:
  LightClip(const LightScene& scene, std::uint64_t seed, int frames) : how_(scene), seed_(seed) {
    camera_.height = static_cast<int>(2.4 * scene.radius_px) + 40;
    camera_.width = camera_.height + scene.wider_px;
    camera_.psf_sigma_px = scene.blur_px;
    camera_.noise_sigma = scene.noise;
    camera_.noise_seed = seed + 1;
    camera_.shading = scene.shading;
    camera_.lamp_deg = 135 + 47.0 * static_cast<double>(seed);
    camera_.lamp_share = scene.lamp_share;
    camera_.lamp_elevation_deg = scene.lamp_elevation_deg;
    camera_.limb_darkening = scene.limb_darkening;
    lay_path(frames);
    if (scene.hidden > 0) {
      camera_.bar = sim::speckle::bar_hiding(scene.hidden, poses_[poses_.size() / 2],
                                             scene.radius_px, scene.bar_angle_deg);
      camera_.bar->level = scene.bar_level;
    }
  }

  const std::vector<BallPose>& poses() const { return poses_; }
  // What a frame shows of the ball: its mean compression while the shutter is open.
  BallPose exposed(std::size_t index) const {
    const sim::speckle::ShutterPath path = sim::speckle::shutter_path(poses_, index, how_.exposure);
    BallPose pose = path.middle;
    pose.compression =
        (path.open.compression + 2 * path.middle.compression + path.close.compression) / 4;
    return pose;
  }
  int width() const { return camera_.width; }
  int height() const { return camera_.height; }

  void render(std::size_t index, Frame& out) {
    if (!before_dark_) make_renderers();
    const sim::speckle::ShutterPath path = sim::speckle::shutter_path(poses_, index, how_.exposure);
    Image<double> grey = exact(*before_dark_, path);
    if (before_white_) {
      // The share of the background that each pixel shows, exactly.
      const Image<double> white = exact(*before_white_, path);
      for (int y = 0; y < grey.height(); ++y) {
        for (int x = 0; x < grey.width(); ++x) {
          const double free = (white(x, y) - grey(x, y)) / kBright;
          grey(x, y) += free * (backdrop_level(how_.backdrop, seed_, x, y) - kDark);
        }
      }
    }
    for (int y = 0; y < grey.height(); ++y) {
      for (int x = 0; x < grey.width(); ++x) grey(x, y) *= how_.gain;
    }
    sim::speckle::develop(grey, camera_, static_cast<std::int64_t>(index), out);
  }

 private:
  using Renderer = sim::speckle::FrameRenderer;
  static constexpr double kDark = 30, kBright = 100;

  void lay_path(int frames) {
    const double a = static_cast<double>(seed_);
    const double middle_x = 0.5 * (camera_.width - 1), middle_y = 0.5 * (camera_.height - 1);
    ConstantMotion motion;
    motion.dx_px = how_.enters ? 2.0 * camera_.width / frames : how_.dx_px;
    motion.dy_px = how_.enters ? 0.3 : how_.dy_px;
    motion.rotation_deg = how_.rotation_deg;
    if (how_.sphere) {
      motion.spin_x_deg = how_.spin_x_deg;
      motion.spin_y_deg = how_.spin_y_deg;
    }
    motion.start.cx_px =
        middle_x + std::fmod(0.3819660113 * a + 0.13, 1) - motion.dx_px * frames / 2;
    motion.start.cy_px =
        middle_y + std::fmod(0.6180339887 * a + 0.41, 1) - motion.dy_px * frames / 2;
    motion.start.angle_deg = 17 * a;
    motion.start.compression = how_.compression;
    motion.start.compression_axis_deg = 90;
    poses_ = sim::speckle::constant_motion(motion, frames);
    const double third = (frames - 1) / 3.0;
    for (int k = 0; how_.contact && k < frames; ++k) {
      const double t = (k - third) / third;
      poses_[static_cast<std::size_t>(k)].compression *= t > 0 && t < 1 ? std::sin(kPi * t) : 0.0;
    }
  }

  std::unique_ptr<Renderer> renderer(double background) const {
    SynthScene scene = camera_;
    scene.background = background;
    if (how_.sphere) {
      return std::make_unique<sim::speckle::SphereRenderer>(
          sim::speckle::paint_sphere(how_.pattern, seed_, how_.radius_px), scene);
    }
    return std::make_unique<sim::speckle::BallRenderer>(
        sim::speckle::paint_ball(how_.pattern, seed_, how_.radius_px), scene);
  }
  void make_renderers() {
    before_dark_ = renderer(kDark);
    if (how_.backdrop != Backdrop::kEven) before_white_ = renderer(kDark + kBright);
  }
  Image<double> exact(const Renderer& of, const sim::speckle::ShutterPath& path) const {
    if (how_.sphere) return static_cast<const sim::speckle::SphereRenderer&>(of).exact(path);
    return static_cast<const sim::speckle::BallRenderer&>(of).exact(path);
  }

  LightScene how_;
  std::uint64_t seed_;
  SynthScene camera_;
  std::vector<BallPose> poses_;
  std::unique_ptr<Renderer> before_dark_, before_white_;
};

}  // namespace impactdic::testing
