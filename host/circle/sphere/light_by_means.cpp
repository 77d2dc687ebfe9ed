#include "host/circle/sphere/light_by_means.h"

#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "host/base/statistics.h"
#include "host/circle/settings/sphere.h"
#include "host/circle/sphere/light_cells.h"

namespace impactdic::circle {
namespace {

// Every sample as a share of the light there.
template <typename Use>
void for_each_seen(const SphereSamples& samples, const SphereLight& light, const Use& use) {
  for (const auto& d : samples.directions) {
    const auto &x = samples.x[d.layer], &z = samples.z[d.layer];
    for (int k = 0; k < kRings; ++k) {
      const double level = light.at(static_cast<double>(x[k] * d.cos),
                                    static_cast<double>(x[k] * d.sin), static_cast<double>(z[k]));
      if (level > 0) use(static_cast<double>(d.seen[k]) / level);
    }
  }
}

// Share of what the ball shows that is bare paint in this light.
double bare_share(const SphereSamples& samples, const SphereLight& light) {
  std::size_t bare = 0, all = 0;
  for_each_seen(samples, light, [&](double share) {
    ++all;
    bare += std::abs(share - 1) < kSphere.bare;
  });
  return static_cast<double>(bare) / static_cast<double>(std::max<std::size_t>(all, 1));
}

// Cells count by how much ink they hold: by the surface, and not by what is seen of it.
class Means : public LightCells {
 public:
  Means(const SphereSamples& samples, double ground) : LightCells(samples, ground, false) {}

  // Whether what the ball shows in the mean contradicts the light: it changes with the direction by
  // more than it scatters from sector to sector, and it scatters by less than the light may be
  // wrong that so much bare paint has told.
  bool is_contradicted(const SphereLight& light) const {
    std::array<double, kLevelSectors> sum{}, weight{};
    for (const Cell& cell : cells_) {
      const int sector = samples_.directions[cell.begin].sector;
      const double ink = std::hypot(cell.x, cell.y);
      sum[sector] += ink * cell.mean / light.at(cell.x, cell.y, cell.z);
      weight[sector] += ink;
    }
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    double squares = 0, sectors = 0;
    for (int k = 0; k < kLevelSectors; ++k) {
      if (weight[k] == 0) continue;
      const double angle = 2 * kPi * k / kLevelSectors, shown = sum[k] / weight[k];
      const Eigen::Vector3d j{1, std::cos(angle), std::sin(angle)};
      a += j * j.transpose();
      b += shown * j;
      squares += shown * shown;
      ++sectors;
    }
    if (sectors < 0.5 * kLevelSectors) return false;
    const Eigen::Matrix3d inverse = a.inverse();
    const Eigen::Vector3d w = inverse * b;
    const double variance = std::max(0.0, squares - w.dot(b)) / (sectors - 3);
    const Eigen::Matrix2d covariance = variance * inverse.bottomRightCorner<2, 2>();
    const double told = std::pow(kSphere.paint_tells / bare_share(samples_, light), 2);
    if (kSphere.surely * std::sqrt(covariance.trace() / 2) > told * w[0]) return false;
    const Eigen::Vector2d along = w.tail<2>();
    return along.dot(covariance.ldlt().solve(along)) >
           kSphere.contradiction * kSphere.contradiction;
  }

  // By what the ball shows in the mean, as bright as its brightest places. nullopt where nothing of
  // it is bright.
  std::optional<SphereLight> by_means(const SphereLight& near) const {
    SphereLight shape = near;
    for (int pass = 0; pass < kSphere.mean_passes; ++pass) step_to_means(shape);
    std::vector<float> shares;
    for_each_seen(samples_, shape,
                  [&](double share) { shares.push_back(static_cast<float>(share)); });
    if (shares.empty()) return std::nullopt;
    const auto paint = static_cast<double>(quantile(shares, kSphere.bright));
    const SphereLight light = times(shape, paint, 1 / paint);
    return is_finite(light) ? std::optional(light) : std::nullopt;
  }

  // The same light, told by the mean, as bright as it is now.
  SphereLight as_bright(const SphereLight& light) const {
    std::vector<double> shares;
    for (const Cell& cell : cells_) {
      shares.push_back(cell.mean / light.at(cell.x, cell.y, cell.z));
    }
    return times(light, upper_median(std::move(shares)) / light.shown(), light.shown());
  }

 private:
  // A step towards the means of the cells. Those far off show something else.
  void step_to_means(SphereLight& light) const {
    Normal normal;
    hold(light, kSphere.mean_held, normal);
    for (const Cell& cell : cells_) {
      const double level = light.at(cell.x, cell.y, cell.z), off = cell.mean - level;
      const double sds = off / (kSphere.mean_sd * std::max(level, 1.0));
      const double ink = std::hypot(cell.x, cell.y);
      normal.add(slope_of(light, cell.x, cell.y, cell.z), ink / (1 + sds * sds), off);
    }
    light = stepped(light, normal.solution());
  }
};

}  // namespace

bool hides_paint(const SphereSamples& samples, const SphereLight& light) {
  return bare_share(samples, light) < kSphere.much_bare;
}

SphereLight checked_by_means(const SphereSamples& samples, double ground,
                             const SphereLight& light) {
  const Means means(samples, ground);
  if (!means.has_enough() || !means.is_contradicted(light)) return light;
  return means.by_means(light).value_or(light);
}

std::optional<SphereLight> as_bright(const SphereSamples& samples, double ground,
                                     const SphereLight& light) {
  const Means means(samples, ground);
  if (!means.has_enough()) return std::nullopt;
  const SphereLight now = means.as_bright(light);
  return is_finite(now) ? std::optional(now) : std::nullopt;
}

}  // namespace impactdic::circle
