#include "host/circle/sphere/sphere_light.h"

#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "host/base/statistics.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/settings/sphere.h"

namespace impactdic::circle {
namespace {

using Terms = Eigen::Matrix<double, kLightTerms, 1>;
using Matrix = Eigen::Matrix<double, kLightTerms, kLightTerms>;

// Two circles of samples a cell.
constexpr int kRingsOfCell = 2, kRingCells = kRings / kRingsOfCell;
constexpr int kCells = kLevelSectors * kRingCells;

// How the level changes with the terms.
Terms slope_of(const SphereLight& light, double x, double y, double z) {
  const LightTerms& w = light.terms();
  const double lamp = w[1] * x + w[2] * y + w[3] * z;
  const double limb = 1 - w[4] * (1 - z), lit = lamp > 0 ? limb : 0;
  Terms slope;
  slope << limb, lit * x, lit * y, lit * z, -(w[0] + std::max(0.0, lamp)) * (1 - z), x, y, z,
      x * x - y * y, 2 * x * y, x * z, y * z, 1 - z * z;
  return slope;
}

bool is_finite(const SphereLight& light) {
  return std::isfinite(light.shown()) &&
         std::ranges::all_of(light.terms(), [](double term) { return std::isfinite(term); });
}

// The fit. Cells are parts of a sector between two circles. They count by the square of the cosine
// to the line of sight: the nearer to the rim, the more ink is mixed into all that is seen.
class Fit {
 public:
  // `from_nothing` needs to know how bright the cells are.
  Fit(const SphereSamples& samples, double ground, double noise, bool with_brightness)
      : samples_(samples), ground_(ground), noise_(noise) {
    make_cells(with_brightness);
  }
  bool has_enough() const { return cells_.size() >= static_cast<std::size_t>(kSphere.least_cells); }

  SphereLight from_nothing() {
    double lowest = 1e300;
    const LightTerms flat = brightness();
    SphereLight best;
    for (const double elevation : kSphere.start_deg) {
      SphereLight light(start_of(flat, elevation * kRadPerDeg));
      double cost = 0;
      for (int pass = 0; pass < kSphere.envelope_passes; ++pass) cost = envelope(light);
      if (cost < lowest) {
        lowest = cost;
        best = light;
      }
    }
    return best;
  }

  // The light of an earlier frame as bright as it is now. A lamp may have lost more than the
  // windows about the paint's level are wide.
  SphereLight brightened(const SphereLight& light) const {
    const double contrast = brightest(light) - ground_;
    const double window = static_cast<double>(kLevels.window_first) * contrast;
    std::vector<float> off;  // of some samples
    for (std::size_t i = 0; i < samples_.directions.size(); i += kSphere.brightness_every) {
      const auto& d = samples_.directions[i];
      const auto &x = samples_.x[d.layer], &z = samples_.z[d.layer];
      for (int k = 0; k < kRings; ++k) {
        if (!(d.level[k] > kNoLevel)) continue;
        off.push_back(d.level[k] - static_cast<float>(light.at(static_cast<double>(x[k] * d.cos),
                                                               static_cast<double>(x[k] * d.sin),
                                                               static_cast<double>(z[k]))));
      }
    }
    if (off.empty()) return light;
    const auto crowd = [&](double about) {
      return std::count_if(off.begin(), off.end(), [&](float each) {
        return std::abs(static_cast<double>(each) - about) < window;
      });
    };
    const auto as_before = crowd(0);
    const double by = static_cast<double>(quantile(off, kSphere.bright));
    const bool changed =
        std::abs(by) > window &&
        static_cast<double>(crowd(by)) > kSphere.brighter_crowd * static_cast<double>(as_before);
    const double middle = light.at(0, 0, 1);
    if (!changed || !(std::abs(middle) > 0)) return light;
    return times(light, 1 + by / middle, 0);
  }

  // Share of what the ball shows that is bare paint in this light.
  double bare_share(const SphereLight& light) const {
    std::size_t bare = 0, all = 0;
    for_each_seen(light, [&](double share) {
      ++all;
      bare += std::abs(share - 1) < kSphere.bare;
    });
    return static_cast<double>(bare) / static_cast<double>(std::max<std::size_t>(all, 1));
  }

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
    if (sectors < kLevelSectors / 2) return false;
    const Eigen::Matrix3d inverse = a.inverse();
    const Eigen::Vector3d w = inverse * b;
    const double variance = std::max(0.0, squares - w.dot(b)) / (sectors - 3);
    const Eigen::Matrix2d covariance = variance * inverse.bottomRightCorner<2, 2>();
    const double told = std::pow(kSphere.paint_tells / bare_share(light), 2);
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
    for_each_seen(shape, [&](double share) { shares.push_back(static_cast<float>(share)); });
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

  void settle(SphereLight& light) {
    const double contrast = brightest(light) - ground_;
    for (const float window :
         settling_windows(static_cast<float>(contrast), static_cast<float>(noise_))) {
      for (int pass = 0; pass < kSphere.settling_passes; ++pass) settle(light, window);
    }
  }

 private:
  struct Cell {
    std::size_t begin, end;  // directions
    int ring;                // first of kRingsOfCell
    double x, y, z;
    double bright;  // that one sample in twenty exceeds
    double mean;    // of all samples
  };
  // Normal equations of a step: row by row, of which those columns count that are no less.
  struct Normal {
    static constexpr int kFours = (kLightTerms + 3) / 4;
    FourPlaces rows[kLightTerms][kFours] = {};
    Terms b = Terms::Zero();
    double& diagonal(int m) { return reinterpret_cast<double*>(rows[m])[m]; }
    void add(const Terms& slope, double weight, double off) {
      FourPlaces u[kFours] = {};
      std::memcpy(u, slope.data(), kLightTerms * sizeof(double));
      for (int i = 0; i < kLightTerms; ++i) {
        const double by = weight * slope[i];
        for (int k = i / 4; k < kFours; ++k) rows[i][k] += by * u[k];
      }
      b += weight * off * slope;
    }
    Terms solution() const {
      Matrix a;
      for (int i = 0; i < kLightTerms; ++i) {
        for (int m = i; m < kLightTerms; ++m) a(m, i) = a(i, m) = rows[i][m / 4][m % 4];
      }
      return Eigen::LDLT<Matrix>(a).solve(b);
    }
  };

  void make_cells(bool with_brightness) {
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
  // A plane through the cells' levels: where the lamp is, roughly.
  LightTerms brightness() const {
    Eigen::Matrix3d a = Eigen::Matrix3d::Identity() * 1e-6;
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const Cell& cell : cells_) {
      const Eigen::Vector3d j{1, cell.x, cell.y};
      a += j * j.transpose();
      b += cell.bright * j;
    }
    const Eigen::Vector3d w = a.ldlt().solve(b);
    LightTerms terms{};
    terms[0] = w[0];
    terms[1] = w[1];
    terms[2] = w[2];
    return terms;
  }
  static LightTerms start_of(const LightTerms& flat, double elevation) {
    LightTerms terms = flat;
    const double across = std::hypot(flat[1], flat[2]);
    terms[3] = across * std::tan(elevation);
    terms[0] = flat[0] - terms[3] * 0.7;
    return terms;
  }

  double brightest(const SphereLight& light) const {
    double most = ground_ + 1e-6;
    for (const Cell& cell : cells_) most = std::max(most, light.at(cell.x, cell.y, cell.z));
    return most;
  }

  void hold(const SphereLight& light, double share, Normal& normal) const {
    // No shading of a kind unless it shows. The limb's term has no unit, the others grey levels.
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

  static SphereLight times(const SphereLight& light, double by, double shown) {
    LightTerms terms = light.terms();
    for (int m = 0; m < kLightTerms; ++m) terms[m] *= m == 4 ? 1 : by;
    return SphereLight(terms, shown);
  }

  // Every sample as a share of the light there.
  template <typename Use>
  void for_each_seen(const SphereLight& light, const Use& use) const {
    for (const auto& d : samples_.directions) {
      const auto &x = samples_.x[d.layer], &z = samples_.z[d.layer];
      for (int k = 0; k < kRings; ++k) {
        const double level = light.at(static_cast<double>(x[k] * d.cos),
                                      static_cast<double>(x[k] * d.sin), static_cast<double>(z[k]));
        if (level > 0) use(static_cast<double>(d.seen[k]) / level);
      }
    }
  }

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

  static SphereLight stepped(const SphereLight& light, Terms step) {
    step[4] = std::clamp(step[4], -kSphere.most_limb_step, kSphere.most_limb_step);
    LightTerms terms = light.terms();
    for (int m = 0; m < kLightTerms; ++m) terms[m] += step[m];
    return SphereLight(terms);
  }

  // A step towards the upper envelope of the cells; returns what it left before.
  double envelope(SphereLight& light) const {
    Normal normal;
    hold(light, 1, normal);
    const double below = kLevels.below * (brightest(light) - ground_);
    double cost = 0;
    for (const Cell& cell : cells_) {
      const double off = cell.bright - light.at(cell.x, cell.y, cell.z);
      const double weight = cell.z * cell.z * (off > -below ? 1 : kLevels.below_weight);
      cost += weight * off * off;
      normal.add(slope_of(light, cell.x, cell.y, cell.z), weight, off);
    }
    light = stepped(light, normal.solution());
    return cost;
  }

  // Of the cells of a sector: the sum of what is near the light, and how much of it there is.
  struct Near {
    typedef std::int64_t Whole __attribute__((vector_size(32), aligned(32)));
    FourPlaces sum = {};
    Whole count = {};
  };
  static_assert(kRings == 8 && kRingsOfCell == 2);
  template <int kFirst>
  static void add_near(const std::array<float, kRings>& x, const std::array<float, kRings>& z,
                       const SphereSamples::Direction& d, const LightTerms& terms, double window,
                       Near& near) {
    const auto of = [](const std::array<float, kRings>& all, FourPlaces& v) {
      Lanes each;
      load(all.data(), each);
      v = __builtin_convertvector(
          __builtin_shufflevector(each, each, kFirst, kFirst + 2, kFirst + 4, kFirst + 6),
          FourPlaces);
    };
    FourPlaces at, depth, off, level;
    of(x, at);
    of(z, depth);
    of(d.level, off);
    light_of(terms, FourPlaces(at * d.cos), FourPlaces(at * d.sin), depth, level);
    off -= level;
    const Near::Whole is_near = (off <= window) & (off >= -window);
    near.sum += is_near ? off : FourPlaces{};
    near.count -= is_near;
  }
  void add_near(const SphereSamples::Direction& d, const LightTerms& terms, double window,
                Near& near) const {
    const auto& x = samples_.x[d.layer];
    const auto& z = samples_.z[d.layer];
    // The first circle of each cell, then the second.
    add_near<0>(x, z, d, terms, window, near);
    add_near<1>(x, z, d, terms, window, near);
  }

  void settle(SphereLight& light, float window) const {
    Normal normal;
    hold(light, kSphere.samples_of_cell, normal);
    for (int m = 0; m < kLightTerms; ++m) normal.diagonal(m) += kSphere.damping;
    Near near;
    std::size_t summed = 0;  // up to this direction
    for (const Cell& cell : cells_) {
      if (cell.end != summed) {
        near = {};
        for (std::size_t i = cell.begin; i < cell.end; ++i) {
          add_near(samples_.directions[i], light.terms(), window, near);
        }
        summed = cell.end;
      }
      const int of_sector = cell.ring / kRingsOfCell;
      const auto n = static_cast<double>(near.count[of_sector]);
      if (n == 0) continue;
      normal.add(slope_of(light, cell.x, cell.y, cell.z), n * cell.z * cell.z,
                 near.sum[of_sector] / n);
    }
    light = stepped(light, normal.solution());
  }

  const SphereSamples& samples_;
  const double ground_, noise_;
  std::vector<Cell> cells_;
};

}  // namespace

double SphereLight::at(double x, double y, double z) const {
  double level = 0;
  light_of(w_, x, y, z, level);
  return level;
}

std::optional<SphereLight> fit_sphere_light(const SphereSamples& samples, double ground,
                                            double noise, const SphereLight* start) {
  Fit fit(samples, ground, noise, start == nullptr);
  if (!fit.has_enough()) return std::nullopt;
  SphereLight light;
  if (start && start->shown() > 0) {
    light = fit.as_bright(*start);
  } else {
    light = start ? fit.brightened(*start) : fit.from_nothing();
    fit.settle(light);
  }
  return is_finite(light) ? std::optional(light) : std::nullopt;
}

bool hides_paint(const SphereSamples& samples, double ground, double noise,
                 const SphereLight& light) {
  return Fit(samples, ground, noise, false).bare_share(light) < kSphere.much_bare;
}

SphereLight checked_by_means(const SphereSamples& samples, double ground, double noise,
                             const SphereLight& light) {
  const Fit fit(samples, ground, noise, false);
  if (!fit.has_enough() || !fit.is_contradicted(light)) return light;
  return fit.by_means(light).value_or(light);
}

}  // namespace impactdic::circle
