#include "host/circle/rays/rays.h"

#include <algorithm>
#include <cmath>

#include "host/base/statistics.h"
#include "host/circle/settings/crossings.h"

namespace impactdic::circle {

// Cubic through the four samples about it.
bool falls_through(const float* p, float level, float& at) {
  constexpr int kHalf = Rays::kHalf;
  for (int k = kHalf + 2; k > kHalf - 2; --k) {
    if (p[k - 1] < level || p[k] >= level) continue;
    // On [k−1, k] with t in [0, 1], Lagrange's cubic through k−2 … k+1.
    const float a = p[k - 2], b = p[k - 1], c = p[k], d = p[k + 1];
    const float c1 = -a / 3 - b / 2 + c - d / 6;
    const float c2 = a / 2 - b + c / 2;
    const float c3 = -a / 6 + b / 2 - c / 2 + d / 6;
    float t = (b - level) / (b - c);
    for (int pass = 0; pass < kCrossing.newton; ++pass) {
      const float f = b - level + t * (c1 + t * (c2 + t * c3));
      const float slope = c1 + t * (2 * c2 + t * 3 * c3);
      if (!(slope < 0)) return false;
      t -= f / slope;
    }
    if (t < -0.5f || t > 1.5f) return false;
    at = static_cast<float>(k - 1 - kHalf) + t;
    return true;
  }
  return false;
}

float sample_noise(Rays& rays, int n) {
  rays.scratch.clear();
  for (int i = 3; i < n; i += 3) {
    rays.scratch.push_back(
        std::abs(rays.row(i)[Rays::kLength - 1] - rays.row(i - 3)[Rays::kLength - 1]));
  }
  return noise_of_steps(rays.scratch);
}

float camera_noise(Rays& rays, int n, double per_ray_px, float noise) {
  const int apart = std::max(1, static_cast<int>(std::lround(kUnevenGround.apart_px / per_ray_px)));
  rays.scratch.clear();
  for (int i = apart; i + apart < n; ++i) {
    rays.scratch.push_back(std::abs(rays.row(i - apart)[Rays::kLength - 1] -
                                    2 * rays.row(i)[Rays::kLength - 1] +
                                    rays.row(i + apart)[Rays::kLength - 1]));
  }
  const float bends = noise_of_steps(rays.scratch) / std::sqrt(3.0f);
  return bends < kUnevenGround.bends * noise ? bends : noise;
}

}  // namespace impactdic::circle
