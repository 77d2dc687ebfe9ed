#include "host/circle/rays/uneven_ground.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "host/base/statistics.h"
#include "host/circle/settings/crossings.h"
#include "host/circle/settings/levels.h"

namespace impactdic::circle {
namespace {

// Between the two outermost samples.
float fall(const float* p) { return p[Rays::kLength - 2] - p[Rays::kLength - 1]; }

// A blurred edge reaches to the nearer of the two samples; not where ink has moved it inwards.
float usual_fall(Rays& rays, int n) {
  std::vector<std::pair<float, float>> falls;  // with where the edge is
  rays.scratch.clear();
  for (int i = 0; i < n; ++i) {
    const float* p = rays.row(i);
    float at = 0;
    if (!falls_through(p, 0.5f * (rays.ball[i] + rays.outside[i]), at)) continue;
    falls.emplace_back(at, fall(p));
    rays.scratch.push_back(at);
  }
  if (falls.empty()) return 0;
  const float middle = quantile(rays.scratch, 0.5);
  rays.scratch.clear();
  for (const auto& [at, by] : falls) {
    if (at >= middle) rays.scratch.push_back(by);
  }
  return quantile(rays.scratch, 0.5);
}

}  // namespace

std::optional<UnevenGround> UnevenGround::find(Rays& rays, int n, double per_ray_px, float noise) {
  rays.scratch.clear();
  for (int i = 0; i < n; ++i) {
    rays.scratch.push_back(std::abs(rays.row(i)[Rays::kLength - 1] - rays.outside[i]));
  }
  const float scatter = kLevels.noise_per_median * quantile(rays.scratch, 0.5);
  if (!(scatter > kUnevenGround.noises * noise)) return std::nullopt;
  const int beside = static_cast<int>(std::lround(kUnevenGround.beside_px / per_ray_px));
  return UnevenGround(rays, n, std::max(1, beside), usual_fall(rays, n));
}

float UnevenGround::beside(int i) const {
  constexpr float kOut = static_cast<float>(Rays::kHalf) - kUnevenGround.outside_steps;
  float sum = 0;
  int count = 0;
  for (int k = std::max(0, i - beside_); k <= std::min(n_ - 1, i + beside_); ++k) {
    if (rays_->ray[k] - rays_->ray[i] != k - i) continue;
    const float* p = rays_->row(k);
    sum += p[Rays::kLength - 1] + kOut * (fall(p) - usual_fall_);
    ++count;
  }
  return sum / static_cast<float>(count);
}

}  // namespace impactdic::circle
