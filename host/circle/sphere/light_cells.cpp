#include "host/circle/sphere/light_cells.h"

#include <algorithm>
#include <cmath>

#include "host/base/statistics.h"
#include "host/circle/settings/sphere.h"

namespace impactdic::circle {

bool is_finite(const SphereLight& light) {
  return std::isfinite(light.shown()) &&
         std::ranges::all_of(light.terms(), [](double term) { return std::isfinite(term); });
}

LightCells::LightCells(const SphereSamples& samples, double ground, bool with_brightness)
    : samples_(samples), ground_(ground) {
  const auto& all = samples_.directions;
  std::vector<float> levels;
  for (std::size_t begin = 0; begin < all.size();) {
    std::size_t end = begin;
    while (end < all.size() && all[end].sector == all[begin].sector) ++end;
    const auto& middle = all[(begin + end) / 2];
    for (int ring = 0; ring < kRings; ring += kRingsOfCell) {
      levels.clear();
      double sum = 0;
      for (std::size_t i = begin; i < end; ++i) {
        for (int k = ring; k < ring + kRingsOfCell; ++k) {
          sum += static_cast<double>(all[i].seen[k]);
          if (all[i].level[k] > kNoLevel) levels.push_back(all[i].level[k]);
        }
      }
      if (levels.size() < kSphere.cell_samples) continue;
      const auto& ring_x = samples_.x[samples_.x.size() / 2];
      const double x = 0.5 * static_cast<double>(ring_x[ring] + ring_x[ring + 1]);
      const double bright =
          with_brightness ? static_cast<double>(quantile(levels, kSphere.bright)) : 0;
      const double mean = sum / static_cast<double>(kRingsOfCell * (end - begin));
      cells_.push_back(
          {begin, end, ring, x * middle.cos, x * middle.sin, std::sqrt(1 - x * x), bright, mean});
    }
    begin = end;
  }
}
bool LightCells::has_enough() const {
  return cells_.size() >= static_cast<std::size_t>(kSphere.least_cells);
}

LightCells::Terms LightCells::slope_of(const SphereLight& light, double x, double y, double z) {
  const LightTerms& w = light.terms();
  const double lamp = w[1] * x + w[2] * y + w[3] * z;
  const double limb = 1 - w[4] * (1 - z), lit = lamp > 0 ? limb : 0;
  Terms slope;
  slope << limb, lit * x, lit * y, lit * z, -(w[0] + std::max(0.0, lamp)) * (1 - z), x, y, z,
      x * x - y * y, 2 * x * y, x * z, y * z, 1 - z * z;
  return slope;
}

double LightCells::brightest(const SphereLight& light) const {
  double most = ground_ + 1e-6;
  for (const Cell& cell : cells_) most = std::max(most, light.at(cell.x, cell.y, cell.z));
  return most;
}

void LightCells::hold(const SphereLight& light, double share, Normal& normal) const {
  // The limb's term has no unit, the others grey levels.
  const double scale = brightest(light) - ground_;
  for (int m = 1; m < kLightTerms; ++m) {
    const double weight = share * (m == 4  ? kSphere.held_limb * scale * scale
                                   : m > 4 ? kSphere.held_soft
                                           : kSphere.held_lamp);
    normal.diagonal(m) += weight;
    normal.b[m] -= weight * light.terms()[m];
  }
  normal.diagonal(0) += 1e-6;
}

SphereLight LightCells::stepped(const SphereLight& light, Terms step) {
  step[4] = std::clamp(step[4], -kSphere.most_limb_step, kSphere.most_limb_step);
  LightTerms terms = light.terms();
  for (int m = 0; m < kLightTerms; ++m) terms[m] += step[m];
  return SphereLight(terms);
}

SphereLight LightCells::times(const SphereLight& light, double by, double shown) {
  LightTerms terms = light.terms();
  for (int m = 0; m < kLightTerms; ++m) terms[m] *= m == 4 ? 1 : by;
  return SphereLight(terms, shown);
}

}  // namespace impactdic::circle
