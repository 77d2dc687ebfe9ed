// The light on a sphere, fixed to the camera: what its bare paint shows where the surface has a
// given normal. Internal to host/circle.
//
//   level(n) = (ambient + max(0, lamp · n)) (1 − limb (1 − n_z)) + Σ soft_m Y_m(n)
//
// with n = (x, y, z), x right, y down, z towards the camera: ambient light and a far lamp (Lambert,
// 1760), limb darkening (Milne, 1921), and harmonics of the second order for lamps that are broad
// or many (Ramamoorthi and Hanrahan, 2001). It is found as the flat paint's level is
// (rim_levels.h): an upper envelope of cells that settles on the crowd about it. Fine and dense ink
// leaves no such crowd. It darkens all of the ball alike, so that what the ball shows in the mean
// tells the light there.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "host/circle/rim/lanes.h"
#include "host/circle/rim/rim.h"

namespace impactdic::circle {

inline constexpr int kLightTerms = 13;

// Ambient, lamp (x, y, z), limb, soft.
typedef std::array<double, kLightTerms> LightTerms;

// Four numbers at a time.
typedef double FourPlaces __attribute__((vector_size(32), aligned(32)));

// The level of `terms` at a place, or at several.
template <typename T>
[[gnu::always_inline]] inline void light_of(const LightTerms& w, const T& x, const T& y, const T& z,
                                            T& level) {
  const T lit = w[1] * x + w[2] * y + w[3] * z;
  const T lamp = w[0] + (lit > 0 ? lit : T{});
  level = lamp * (1 - w[4] * (1 - z)) + w[5] * x + w[6] * y + w[7] * z + w[8] * (x * x - y * y) +
          w[9] * 2 * x * y + w[10] * x * z + w[11] * y * z + w[12] * (1 - z * z);
}

class SphereLight {
 public:
  SphereLight() = default;
  explicit SphereLight(const LightTerms& terms, double shown = 0) : w_(terms), shown_(shown) {}
  const LightTerms& terms() const { return w_; }
  double at(double x, double y, double z) const;
  // Where ink leaves too little bare paint to tell the light: the mean of what the ball shows over
  // it, which told the light instead. 0 elsewhere.
  double shown() const { return shown_; }

 private:
  LightTerms w_{};
  double shown_ = 0;
};

// Samples of a sphere's inside along directions from the centre, at kRings normals of the surface.
inline constexpr int kDirections = 480, kRings = 8;
inline constexpr float kNoLevel = -1e9f;
struct SphereSamples {
  struct Direction {
    float cos, sin;
    int layer;
    int sector;  // of kLevelSectors
    std::array<float, kRings> seen;
    std::array<float, kRings> level;  // the same, kNoLevel where ink ends beside it
  };
  std::vector<Direction> directions;  // those that show the ball, in the order of the angle
  // Of the normals: distance from the axis of sight, and along. Each layer has its own circles.
  std::vector<std::array<float, kRings>> x, z;
  std::vector<float> rises;  // memory only
};
// `step_px` of the lines across the rim; `noise` of a sample; `layers` times as many samples.
// `samples` keeps its memory from call to call.
void sample_sphere(const Frame& frame, const Rim& rim, Polarity polarity, double step_px,
                   double noise, int layers, SphereSamples& samples);

// `ground`: the background's level; `noise` of a sample; `start`: the light of an earlier frame.
// nullopt where too little of the ball is seen.
std::optional<SphereLight> fit_sphere_light(const SphereSamples& samples, double ground,
                                            double noise, const SphereLight* start);

}  // namespace impactdic::circle
