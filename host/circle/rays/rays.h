// Grey levels along rays across an expected rim. Internal to host/circle.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "host/circle/rim/rim_levels.h"

namespace impactdic::circle {

// n rays that lie in the picture.
struct Rays {
  static constexpr int kHalf = 3;  // a profile is 2·kHalf + 1 samples about the expected rim
  static constexpr int kLength = 2 * kHalf + 1;

  std::vector<float> cos, sin;                           // all rays in view
  std::vector<int> ray;                                  // number of the ray, 0 … count − 1
  std::vector<float> profile;                            // (rays, kLength), from inside to outside
  std::array<std::vector<float>, kLevelSectors> ground;  // samples 2 … 4 steps outside, by sector
  std::vector<float> ball, outside;                      // levels at each ray
  std::vector<float> scratch;

  void resize(int n) {
    ball.resize(n);
    outside.resize(n);
    cos.resize(n);
    sin.resize(n);
    ray.resize(n);
    profile.resize(static_cast<std::size_t>(n) * kLength);
    for (auto& sector : ground) sector.clear();
  }
  const float* row(int i) const { return profile.data() + static_cast<std::size_t>(i) * kLength; }
};

// Where a profile falls through `level`, in steps from the expected rim; outermost, within two
// steps. False where it does not.
bool falls_through(const float* profile, float level, float& at);

// Noise of one profile sample: from ray to ray outside the ball, where nothing else changes.
float sample_noise(Rays& rays, int n);
// The same where `noise` is what the background's texture changes by: what bends from ray to ray.
float camera_noise(Rays& rays, int n, double per_ray_px, float noise);

}  // namespace impactdic::circle
