// Conditions that nobody chose: what a ball is, how it is lit and filmed is drawn from a seed, all
// at once and over the whole range that the program is made for.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <sstream>
#include <string>

#include "tests/support/light_scenes.h"

namespace impactdic::testing {

// Numbers of one scene, in the order in which they are asked for.
class SceneDice {
 public:
  explicit SceneDice(std::uint64_t seed) : random_(static_cast<std::mt19937::result_type>(seed)) {}
  double between(double low, double high) { return low + (high - low) * share(); }
  double between_logs(double low, double high) {
    return low * std::exp(share() * std::log(high / low));
  }
  bool chance(double of) { return share() < of; }

 private:
  // The same on every system, which the library's distributions are not.
  double share() { return (random_() >> 5) / 134217728.0; }
  std::mt19937 random_;
};

inline LightScene random_scene(std::uint64_t seed) {
  constexpr std::array kPatterns = {"a1", "a2", "a3", "b1", "b2", "b3", "c1", "c2",
                                    "c3", "d1", "d2", "d3", "e1", "e2", "f1", "f2"};
  SceneDice dice(seed);
  LightScene scene;
  scene.name = "random";
  scene.sphere = dice.chance(0.6);
  scene.pattern = kPatterns[static_cast<std::size_t>(dice.between(0, kPatterns.size()))];
  scene.radius_px = dice.between_logs(30, 150);
  scene.noise = dice.between_logs(0.7, 8);
  scene.blur_px = dice.between(0.4, 1.2);
  scene.gain = dice.between_logs(0.4, 1.2);
  if (dice.chance(0.3)) scene.shading = dice.between(0, 0.5);
  if (dice.chance(0.5)) {
    scene.lamp_share = dice.between(0.1, 0.8);
    scene.lamp_elevation_deg = dice.between(0, 70);
  }
  if (dice.chance(0.3)) scene.limb_darkening = dice.between(0, 0.4);
  if (dice.chance(0.3)) {
    scene.hidden = dice.between(0.05, 0.35);
    scene.bar_angle_deg = dice.between(0, 180);
    scene.bar_level = dice.between(10, 200);
  }
  if (dice.chance(0.25)) {
    scene.compression = dice.between(0.01, 0.12);
    scene.contact = dice.chance(0.7);
  }
  const double behind = dice.between(0, 1);
  if (behind < 0.35) scene.backdrop = behind < 0.2 ? Backdrop::kWood : Backdrop::kTiles;
  const double speed = dice.between_logs(0.05, 6), way = dice.between(0, 2 * kPi);
  scene.dx_px = speed * std::cos(way);
  scene.dy_px = speed * std::sin(way);
  if (dice.chance(0.25)) scene.exposure = dice.between(0.1, 0.8);
  const double turn = dice.between_logs(0.05, 5);
  scene.spin_x_deg = turn * dice.between(-1, 1);
  scene.spin_y_deg = turn * dice.between(-1, 1);
  scene.rotation_deg = turn * dice.between(-1, 1);
  scene.enters = dice.chance(0.1);
  return scene;
}

// In a line.
inline std::string described(const LightScene& scene) {
  std::ostringstream text;
  text.precision(3);
  text << (scene.sphere ? "sphere " : "disc ") << scene.pattern << " R " << scene.radius_px
       << " noise " << scene.noise << " blur " << scene.blur_px << " gain " << scene.gain;
  if (scene.shading > 0) text << " shading " << scene.shading;
  if (scene.lamp_share > 0) {
    text << " lamp " << scene.lamp_share << " at " << scene.lamp_elevation_deg << " deg";
  }
  if (scene.limb_darkening > 0) text << " limb " << scene.limb_darkening;
  if (scene.hidden > 0) {
    text << " bar " << scene.hidden << " at " << scene.bar_angle_deg << " deg level "
         << scene.bar_level;
  }
  if (scene.compression > 0) {
    text << (scene.contact ? " contact " : " compressed ") << scene.compression;
  }
  if (scene.backdrop != Backdrop::kEven) {
    text << (scene.backdrop == Backdrop::kWood ? " wood" : " tiles");
  }
  text << " moves " << scene.dx_px << ", " << scene.dy_px << " turns " << scene.spin_x_deg << ", "
       << scene.spin_y_deg << ", " << scene.rotation_deg;
  if (scene.exposure > 0) text << " exposure " << scene.exposure;
  if (scene.enters) text << " enters";
  return text.str();
}

}  // namespace impactdic::testing
