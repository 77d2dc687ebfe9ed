#include "host/circle/sphere/sphere_light.h"

#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/base/statistics.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/settings/sphere.h"
#include "host/circle/sphere/light_by_means.h"
#include "host/circle/sphere/light_cells.h"

namespace impactdic::circle {
namespace {

// By bare paint. Cells count by the square of the cosine to the line of sight: the nearer to the
// rim, the more ink is mixed into all that is seen.
class Fit : public LightCells {
 public:
  // `from_nothing` needs to know how bright the cells are.
  Fit(const SphereSamples& samples, double ground, double noise, bool with_brightness)
      : LightCells(samples, ground, with_brightness), noise_(noise) {}

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

  void settle(SphereLight& light) {
    const double contrast = brightest(light) - ground_;
    for (const float window :
         settling_windows(static_cast<float>(contrast), static_cast<float>(noise_))) {
      for (int pass = 0; pass < kSphere.settling_passes; ++pass) settle(light, window);
    }
  }

 private:
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

  const double noise_;
};

}  // namespace

double SphereLight::at(double x, double y, double z) const {
  double level = 0;
  light_of(w_, x, y, z, level);
  return level;
}

std::optional<SphereLight> fit_sphere_light(const SphereSamples& samples, double ground,
                                            double noise, const SphereLight* start) {
  if (start && start->shown() > 0) return as_bright(samples, ground, *start);
  Fit fit(samples, ground, noise, start == nullptr);
  if (!fit.has_enough()) return std::nullopt;
  SphereLight light = start ? fit.brightened(*start) : fit.from_nothing();
  fit.settle(light);
  return is_finite(light) ? std::optional(light) : std::nullopt;
}

}  // namespace impactdic::circle
