#include "host/circle/sphere/sphere_light.h"

#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

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

template <typename T>
void sample(ImageView<const T> picture, const Rim& rim, float sign, double step_px, float noise,
            SphereSamples& samples) {
  const Sampler<T> sampler(picture);
  const auto outside = static_cast<float>(1 + kOutside * step_px / rim.r);
  const float uneven = kSphere.uneven_noise * noise + kSphere.uneven_least;
  samples.directions.clear();
  std::vector<float> rises;
  const int layers = static_cast<int>(samples.x.size());
  for (int i = 0; i < layers * kDirections; ++i) {
    const int layer = i % layers, side = i / layers;
    const std::array<float, kRings>& ring_x = samples.x[layer];
    const double angle = (side + 0.5) * 2 * kPi / kDirections - kPi / 4;
    SphereSamples::Direction d{
        static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), layer, {}};
    const auto reach = static_cast<float>(
        rim.radius_at(d.cos * d.cos - d.sin * d.sin, 2.0 * static_cast<double>(d.cos * d.sin)));
    const auto x = [&](float share) { return static_cast<float>(rim.cx) + share * reach * d.cos; };
    const auto y = [&](float share) { return static_cast<float>(rim.cy) + share * reach * d.sin; };
    if (!sampler.inside(x(outside), y(outside), kSphere.margin_px) ||
        !sampler.inside(x(ring_x[kRings - 1]), y(ring_x[kRings - 1]), kSphere.margin_px)) {
      continue;
    }
    // Where ink ends the level is neither paint's nor ink's.
    float brightest = kNoLevel;
    const float beside = kSphere.beside_px / static_cast<float>(rim.r);
    for (int k = 0; k < kRings; ++k) {
      const auto level = [&](float share) { return sign * sampler.bilinear(x(share), y(share)); };
      const float here = level(ring_x[k]);
      const bool flat = std::abs(level(ring_x[k] - beside) - here) < uneven &&
                        std::abs(level(ring_x[k] + beside) - here) < uneven;
      d.level[k] = flat ? here : kNoLevel;
      if (k <= kRingsOfCell) brightest = std::max(brightest, here);
    }
    const float beyond = sign * sampler.bilinear(x(outside), y(outside));
    rises.push_back(brightest - beyond);
    samples.directions.push_back(d);
  }
  if (rises.empty()) return;
  // Only the directions that show the ball: something inside that is brighter than outside.
  const float least = kClear.nothing * quantile(rises, kLineLevels.rise_rank);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rises.size(); ++i) {
    if (rises[i] > least) samples.directions[kept++] = samples.directions[i];
  }
  samples.directions.resize(kept);
}

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

// The fit. Cells are parts of a sector between two circles. They count by the square of the cosine
// to the line of sight: the nearer to the rim, the more ink is mixed into all that is seen.
class Fit {
 public:
  Fit(const SphereSamples& samples, double ground, double noise)
      : samples_(samples), ground_(ground), noise_(noise) {
    make_cells();
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
  };
  // Normal equations of a step.
  struct Normal {
    Matrix a = Matrix::Zero();
    Terms b = Terms::Zero();
    void add(const Terms& slope, double weight, double off) {
      a.selfadjointView<Eigen::Lower>().rankUpdate(slope, weight);
      b += weight * off * slope;
    }
    Terms solution() const {
      return Eigen::LDLT<Matrix>(a.selfadjointView<Eigen::Lower>()).solve(b);
    }
  };

  void make_cells() {
    const auto& all = samples_.directions;
    std::vector<float> levels;
    for (std::size_t begin = 0; begin < all.size();) {
      const int sector = sector_of(all[begin]);
      std::size_t end = begin;
      while (end < all.size() && sector_of(all[end]) == sector) ++end;
      const auto& middle = all[(begin + end) / 2];
      for (int ring = 0; ring < kRings; ring += kRingsOfCell) {
        levels.clear();
        for (std::size_t i = begin; i < end; ++i) {
          for (int k = ring; k < ring + kRingsOfCell; ++k) {
            if (all[i].level[k] > kNoLevel) levels.push_back(all[i].level[k]);
          }
        }
        if (levels.size() < kSphere.cell_samples) continue;
        const auto& ring_x = samples_.x[samples_.x.size() / 2];
        const double x = 0.5 * static_cast<double>(ring_x[ring] + ring_x[ring + 1]);
        cells_.push_back({begin, end, ring, x * middle.cos, x * middle.sin, std::sqrt(1 - x * x),
                          quantile(levels, kSphere.bright)});
      }
      begin = end;
    }
  }
  static int sector_of(const SphereSamples::Direction& d) {
    const double turn = std::atan2(d.sin, d.cos) / (2 * kPi) + 0.125;
    return static_cast<int>((turn - std::floor(turn)) * kLevelSectors);
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
      normal.a(m, m) += weight;
      normal.b[m] -= weight * light.terms()[m];
    }
    normal.a(0, 0) += 1e-6;
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

  void settle(SphereLight& light, float window) const {
    Normal normal;
    hold(light, kSphere.samples_of_cell, normal);
    normal.a.diagonal().array() += kSphere.damping;
    for (const Cell& cell : cells_) {
      double sum = 0;
      int n = 0;
      for (std::size_t i = cell.begin; i < cell.end; ++i) {
        const auto& d = samples_.directions[i];
        for (int k = cell.ring; k < cell.ring + kRingsOfCell; ++k) {
          const double x = samples_.x[d.layer][k];
          const double off = d.level[k] - light.at(x * d.cos, x * d.sin, samples_.z[d.layer][k]);
          const bool near = std::abs(off) <= window;
          sum += near ? off : 0;
          n += near;
        }
      }
      if (n == 0) continue;
      normal.add(slope_of(light, cell.x, cell.y, cell.z), n * cell.z * cell.z, sum / n);
    }
    light = stepped(light, normal.solution());
  }

  const SphereSamples& samples_;
  const double ground_, noise_;
  std::vector<Cell> cells_;
};

}  // namespace

double SphereLight::at(double x, double y, double z) const {
  const double lamp = w_[0] + std::max(0.0, w_[1] * x + w_[2] * y + w_[3] * z);
  return lamp * (1 - w_[4] * (1 - z)) + w_[5] * x + w_[6] * y + w_[7] * z +
         w_[8] * (x * x - y * y) + w_[9] * 2 * x * y + w_[10] * x * z + w_[11] * y * z +
         w_[12] * (1 - z * z);
}

void sample_sphere(const Frame& frame, const Rim& rim, Polarity polarity, double step_px,
                   double noise, int layers, SphereSamples& samples) {
  const double most = std::asin(std::clamp(1 - (kInside + 1) * step_px / rim.r, 0.3, 0.99));
  samples.x.resize(layers);
  samples.z.resize(layers);
  for (int layer = 0; layer < layers; ++layer) {
    for (int k = 0; k < kRings; ++k) {
      const double part = (k + layer / static_cast<double>(layers)) / (kRings - 1.0);
      const double angle = std::lerp(most, kSphere.least_deg * kRadPerDeg, part);
      samples.x[layer][k] = static_cast<float>(std::sin(angle));
      samples.z[layer][k] = static_cast<float>(std::cos(angle));
    }
  }
  if (frame.type == PixelType::kU8) {
    sample(frame.u8.view(), rim, sign_of(polarity), step_px, static_cast<float>(noise), samples);
  } else {
    sample(frame.u16.view(), rim, sign_of(polarity), step_px, static_cast<float>(noise), samples);
  }
}

std::optional<SphereLight> fit_sphere_light(const SphereSamples& samples, double ground,
                                            double noise, const SphereLight* start) {
  Fit fit(samples, ground, noise);
  if (!fit.has_enough()) return std::nullopt;
  SphereLight light = start ? *start : fit.from_nothing();
  fit.settle(light);
  for (const double term : light.terms()) {
    if (!std::isfinite(term)) return std::nullopt;
  }
  return light;
}

}  // namespace impactdic::circle
