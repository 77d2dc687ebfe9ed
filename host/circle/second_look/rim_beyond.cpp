#include "host/circle/second_look/rim_beyond.h"

#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "host/base/statistics.h"
#include "host/circle/rays/ground_plane.h"
#include "host/circle/settings/beyond.h"
#include "host/circle/settings/levels.h"

namespace impactdic::circle {
namespace {

constexpr int kWays = 36;

// A piece of a ring outside the rim: grey levels.
struct Cell {
  float mean = 0, variance = 0;
  float apart = 0;  // half of the mean square of what neighbouring pixels differ by
};

struct Rings {
  double first_px = 0, width_px = 1;  // beyond the rim
  int count = 0;
  int along = 0;  // samples along a cell; there are two across

  int samples() const { return 2 * along; }
  // That tell the background.
  int outermost() const { return std::max(kBeyond.background_rings, count / 3); }
};

Rings rings_of(const Rim& rim, double edge_sigma_px) {
  const double reach = std::max(kBeyond.reach_of_r * rim.r, kBeyond.least_reach_px);
  Rings rings;
  rings.first_px = kBeyond.beside_px + kBeyond.beside_sigmas * edge_sigma_px;
  rings.width_px = std::max(kBeyond.ring_px, reach / kBeyond.rings);
  rings.count = static_cast<int>(reach / rings.width_px);
  const double arc_px = 2 * kPi * rim.r / kWays;
  rings.along = std::clamp(static_cast<int>(arc_px / kBeyond.apart_px), kBeyond.least_samples,
                           kBeyond.most_samples);
  return rings;
}

// A ray outwards, and how far from the centre it leaves the rim.
struct Outward {
  double cos = 1, sin = 0, rim_px = 0;
};
using Fan = std::array<Outward, kBeyond.most_samples>;

// The rays along which the cells of one direction are sampled, the same in every ring.
Fan fan_of(const Rim& rim, const Rings& rings, int direction) {
  Fan fan;
  for (int i = 0; i < rings.along; ++i) {
    const double angle = 2 * kPi * (direction + (i + 0.5) / rings.along) / kWays;
    const double c = std::cos(angle), s = std::sin(angle);
    fan[i] = {c, s, rim.radius_at(c * c - s * s, 2 * c * s)};
  }
  return fan;
}

// nullopt where it does not lie in the picture.
template <typename T>
std::optional<Cell> cell(ImageView<const T> picture, const Rim& rim, const Rings& rings,
                         const Fan& fan, int ring) {
  const Sampler<T> sampler(picture);
  double sum = 0, squares = 0, apart = 0;
  for (int k = 0; k < rings.samples(); ++k) {
    const Outward& ray = fan[k / 2];
    const double across = ring + (k % 2 == 0 ? 0.25 : 0.75);
    const double at = ray.rim_px + rings.first_px + across * rings.width_px;
    const double x = rim.cx + at * ray.cos, y = rim.cy + at * ray.sin;
    if (!sampler.inside(static_cast<float>(x), static_cast<float>(y), 1)) return std::nullopt;
    const int column = static_cast<int>(std::lround(x)), row = static_cast<int>(std::lround(y));
    const auto level = static_cast<double>(picture(column, row));
    const double step = level - static_cast<double>(picture(column + 1, row));
    apart += step * step / 2;
    sum += level;
    squares += level * level;
  }
  const int n = rings.samples();
  return Cell{static_cast<float>(sum / n), static_cast<float>((squares - sum * sum / n) / (n - 1)),
              static_cast<float>(apart / n)};
}

// Of each direction the cells from the rim outwards, as far as the picture goes.
using Cells = std::array<std::vector<Cell>, kWays>;

template <typename T>
Cells cells_beyond(ImageView<const T> picture, const Rim& rim, const Rings& rings) {
  Cells cells;
  for (int d = 0; d < kWays; ++d) {
    const Fan fan = fan_of(rim, rings, d);
    for (int ring = 0; ring < rings.count; ++ring) {
      const std::optional<Cell> next = cell(picture, rim, rings, fan, ring);
      if (!next) break;
      cells[d].push_back(*next);
    }
  }
  return cells;
}

// Each with those beside it in its ring, which noise moves less than one alone.
Cells with_neighbours(const Cells& cells) {
  Cells out;
  for (int d = 0; d < kWays; ++d) {
    const auto& before = cells[(d + kWays - 1) % kWays];
    const auto& after = cells[(d + 1) % kWays];
    const std::size_t rings = std::min({before.size(), cells[d].size(), after.size()});
    for (std::size_t i = 0; i < rings; ++i) {
      out[d].push_back({(before[i].mean + cells[d][i].mean + after[i].mean) / 3,
                        (before[i].variance + cells[d][i].variance + after[i].variance) / 3,
                        (before[i].apart + cells[d][i].apart + after[i].apart) / 3});
    }
  }
  return out;
}

// What lies at the outer ends: a level for each direction, and how cells of it scatter.
struct Surroundings {
  std::array<std::optional<float>, kWays> level;
  // By which it changes from ring to ring, and the ring that has that level.
  std::array<double, kWays> slope{}, at_ring{};
  // What the levels, which differ all around, would have it change by: of light that falls off
  // across the picture it is the same.
  std::array<double, kWays> across{};
  double mean_sd = 0, variance = 0, variance_sd = 0, apart = 0;
  double least_level = kBeyond.least_level;  // grey levels that tell something else
};

float level_at(const Surroundings& back, int direction, std::size_t ring) {
  const double from = static_cast<double>(ring) - back.at_ring[direction];
  return *back.level[direction] + static_cast<float>(back.slope[direction] * from);
}

Eigen::Vector3d wave(int direction) {
  const double angle = 2 * kPi * (direction + 0.5) / kWays;
  return {1, std::cos(angle), std::sin(angle)};
}

// How much brighter the background is farther out, ring by ring: what a lens that darkens the
// picture's corners, or light from one side, makes of it. Least squares over all directions' outer
// ends, even about the rim but for a first wave.
void find_slopes(const Cells& cells, const Rings& rings, Surroundings& back) {
  const auto outermost = static_cast<std::size_t>(rings.outermost());
  Eigen::Matrix3d square = Eigen::Matrix3d::Identity() * 1e-9;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int d = 0; d < kWays; ++d) {
    if (!back.level[d]) continue;
    const std::size_t first = cells[d].size() - outermost;
    back.at_ring[d] = static_cast<double>(first) + 0.5 * static_cast<double>(outermost - 1);
    double mean = 0;
    for (std::size_t i = first; i < cells[d].size(); ++i) mean += cells[d][i].mean;
    mean /= static_cast<double>(outermost);
    for (std::size_t i = first; i < cells[d].size(); ++i) {
      const double from = static_cast<double>(i) - back.at_ring[d];
      square += from * from * wave(d) * wave(d).transpose();
      sum += from * (static_cast<double>(cells[d][i].mean) - mean) * wave(d);
    }
  }
  const Eigen::Vector3d slopes = square.ldlt().solve(sum);
  for (int d = 0; d < kWays; ++d) back.slope[d] = slopes.dot(wave(d));
}

// By how much a plane through the levels rises from ring to ring.
void find_plane(const Rim& rim, const Rings& rings, Surroundings& back) {
  PlaneSums sums;
  for (int d = 0; d < kWays; ++d) {
    if (!back.level[d]) continue;
    const double at_px = rim.r + rings.first_px + (back.at_ring[d] + 0.5) * rings.width_px;
    sums.add(at_px * wave(d)[1], at_px * wave(d)[2], static_cast<double>(*back.level[d]));
  }
  const GroundPlane plane = sums.plane();
  for (int d = 0; d < kWays; ++d) {
    back.across[d] = rings.width_px * (plane.x_px * wave(d)[1] + plane.y_px * wave(d)[2]);
  }
}

Surroundings background_of(const Cells& cells, const Rim& rim, const Rings& rings) {
  const auto outermost = static_cast<std::size_t>(rings.outermost());
  std::array<std::optional<float>, kWays> own;
  std::vector<float> variances, apart;
  for (int d = 0; d < kWays; ++d) {
    if (cells[d].size() < 2 * outermost) continue;
    std::vector<float> means;
    for (std::size_t i = cells[d].size() - outermost; i < cells[d].size(); ++i) {
      means.push_back(cells[d][i].mean);
      variances.push_back(cells[d][i].variance);
      apart.push_back(cells[d][i].apart);
    }
    own[d] = upper_median(means);
  }
  Surroundings back;
  if (variances.empty()) return back;
  for (int d = 0; d < kWays; ++d) {
    if (!own[d]) continue;
    std::vector<float> around;
    for (const int side : {d + kWays - 1, d, d + 1}) {
      if (own[side % kWays]) around.push_back(*own[side % kWays]);
    }
    back.level[d] = upper_median(around);
  }
  back.variance = upper_median(variances);
  back.apart = upper_median(apart);
  back.variance_sd = back.variance * std::sqrt(2 / (3.0 * rings.samples()));
  find_slopes(cells, rings, back);
  find_plane(rim, rings, back);
  return back;
}

double scatter_about(const Surroundings& back, const Cells& cells, const Rings& rings) {
  const auto outermost = static_cast<std::size_t>(rings.outermost());
  std::vector<float> off;
  for (int d = 0; d < kWays; ++d) {
    if (!back.level[d]) continue;
    std::vector<float> levels;
    for (std::size_t i = cells[d].size() - outermost; i < cells[d].size(); ++i) {
      const double from = static_cast<double>(i) - back.at_ring[d];
      levels.push_back(cells[d][i].mean - static_cast<float>(back.slope[d] * from));
    }
    const float own = upper_median(levels);
    for (const float level : levels) off.push_back(std::abs(level - own));
  }
  return static_cast<double>(kLevels.noise_per_median * upper_median(std::move(off)));
}

// How cells scatter about the background. Slopes that are too steep, or leave them scattered nearly
// as widely, are not the background's.
void state_scatter(const Cells& cells, const Rings& rings, double contrast, Surroundings& back) {
  double steepest = 0, off_plane = 0;
  for (int d = 0; d < kWays; ++d) {
    steepest = std::max(steepest, std::abs(back.slope[d]));
    off_plane = std::max(off_plane, std::abs(back.slope[d] - back.across[d]));
  }
  const double rise = std::min(steepest, off_plane) * rings.count;
  if (rise > kBeyond.most_slope * contrast) back.slope = {};
  Surroundings level = back;
  level.slope = {};
  double scatter = scatter_about(back, cells, rings);
  const double of_level = scatter_about(level, cells, rings);
  if (scatter > kBeyond.less_scatter * of_level) {
    scatter = of_level;
    back.slope = {};
  }
  back.mean_sd = std::max(std::sqrt(back.variance / (3.0 * rings.samples())), scatter);
}

// How far on the mean what lies inside the rim is from the background.
template <typename T>
double contrast(ImageView<const T> picture, const Rim& rim, const Surroundings& back) {
  const Sampler<T> sampler(picture);
  double sum = 0;
  int count = 0;
  for (int d = 0; d < kWays; ++d) {
    if (!back.level[d]) continue;
    const double angle = 2 * kPi * (d + 0.5) / kWays;
    for (const double share : kBeyond.inside) {
      const double x = rim.cx + share * rim.r * std::cos(angle);
      const double y = rim.cy + share * rim.r * std::sin(angle);
      if (!sampler.inside(static_cast<float>(x), static_cast<float>(y), 1)) continue;
      const auto level = static_cast<double>(
          picture(static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y))));
      sum += std::abs(level - static_cast<double>(*back.level[d]));
      ++count;
    }
  }
  return count > 0 ? sum / count : 0;
}

double contrast(const Frame& frame, const Rim& rim, const Surroundings& back) {
  return frame.type == PixelType::kU8 ? contrast(frame.u8.view(), rim, back)
                                      : contrast(frame.u16.view(), rim, back);
}

bool is_background(const Cell& cell, float level, const Surroundings& back) {
  const double off = std::abs(static_cast<double>(cell.mean) - static_cast<double>(level));
  const double spread = static_cast<double>(cell.variance) - back.variance;
  const double least = back.least_level;
  return off < kBeyond.of_mean * back.mean_sd + least &&
         spread < kBeyond.of_scatter * back.variance_sd + std::max(least, least * least);
}

// Whether what lies at the outer ends is one level in most of each direction, and noise: beside a
// texture, in which neighbouring pixels are alike, nothing tells what is the ball's.
bool is_even(const Cells& cells, const Rings& rings, const Surroundings& back) {
  if (back.variance > kBeyond.alike * back.apart + kBeyond.least_level) return false;
  if (back.mean_sd > kBeyond.even * std::sqrt(back.variance / (3.0 * rings.samples())))
    return false;
  const auto outermost = static_cast<std::size_t>(rings.outermost());
  int all = 0, other = 0;
  for (int d = 0; d < kWays; ++d) {
    if (!back.level[d]) continue;
    for (std::size_t i = cells[d].size() - outermost; i < cells[d].size(); ++i) {
      ++all;
      other += !is_background(cells[d][i], level_at(back, d, i), back);
    }
  }
  return other < kBeyond.most_uneven * all;
}

// How many cells from the rim outwards are no background; nullopt where that is not told.
using Outs = std::array<std::optional<std::size_t>, kWays>;

Outs outs_of(const Cells& cells, const Surroundings& back) {
  Outs outs;
  for (int d = 0; d < kWays; ++d) {
    if (!back.level[d]) continue;
    std::size_t out = 0;
    while (out < cells[d].size() && !is_background(cells[d][out], level_at(back, d, out), back)) {
      ++out;
    }
    if (out + static_cast<std::size_t>(kBeyond.background_rings) <= cells[d].size()) outs[d] = out;
  }
  return outs;
}

// Of the cells about one, how far apart their means are.
float range_about(const Cells& cells, int direction, std::size_t ring) {
  float least = cells[direction][ring].mean, most = least;
  for (int side = -1; side <= 1; ++side) {
    const std::vector<Cell>& ray = cells[(direction + side + kWays) % kWays];
    for (std::size_t i = ring - std::min<std::size_t>(ring, 1); i < ring + 2 && i < ray.size();
         ++i) {
      least = std::min(least, ray[i].mean), most = std::max(most, ray[i].mean);
    }
  }
  return most - least;
}

// Whether the cells from the rim to the background grow brighter without a texture.
bool brightens(const Cells& cells, int direction, std::size_t out, const Surroundings& back) {
  const std::vector<Cell>& ray = cells[direction];
  const double noise = kBeyond.of_mean * back.mean_sd + back.least_level;
  for (std::size_t i = 0; i < out; ++i) {
    const double smooth =
        kBeyond.shadow_smooth * static_cast<double>(range_about(cells, direction, i));
    const double spread = static_cast<double>(ray[i].variance) - back.variance;
    if (spread > kBeyond.of_scatter * back.variance_sd + smooth * smooth) return false;
    const double next = static_cast<double>(i + 1 < out ? ray[i + 1].mean : *back.level[direction]);
    if (static_cast<double>(ray[i].mean) > next + noise) return false;
  }
  return true;
}

// Whether what adjoins the rim is a shadow that the ball casts on what lies behind it: on one side,
// and nothing but darker, less and less up to the background.
bool is_shadow(const Cells& cells, const Outs& outs, const Surroundings& back) {
  int told = 0, dark = 0, begins = 0, brighter = 0;
  float deepest = 1;  // share of the background's light
  for (int d = 0; d < kWays; ++d) {
    if (!outs[d]) continue;
    ++told;
    if (*outs[d] == 0) continue;
    ++dark;
    const auto& before = outs[(d + kWays - 1) % kWays];
    begins += before && *before == 0;
    brighter += brightens(cells, d, *outs[d], back);
    deepest = std::min(deepest, cells[d][0].mean / level_at(back, d, 0));
  }
  return dark < kBeyond.shadow_share * told && begins <= 1 &&
         brighter >= kBeyond.shadow_most * dark && deepest < kBeyond.shadow_darker;
}

}  // namespace

Beyond beyond_rim(const Frame& frame, const Rim& rim, double edge_sigma_px) {
  const Rings rings = rings_of(rim, edge_sigma_px);
  const Cells cells =
      with_neighbours(frame.type == PixelType::kU8 ? cells_beyond(frame.u8.view(), rim, rings)
                                                   : cells_beyond(frame.u16.view(), rim, rings));
  Surroundings back = background_of(cells, rim, rings);
  const double contrast_of_ball = contrast(frame, rim, back);
  if (back.apart < kBeyond.smoothed && back.variance < kBeyond.plain) {
    back.least_level = std::max(back.least_level, kBeyond.of_contrast * contrast_of_ball);
  }
  state_scatter(cells, rings, contrast_of_ball, back);
  if (!is_even(cells, rings, back)) return {};
  const Outs outs = outs_of(cells, back);
  int told = 0, beyond = 0;
  std::size_t farthest = 0;
  for (const auto& out : outs) {
    if (!out) continue;
    ++told;
    beyond += *out > 0;
    farthest = std::max(farthest, *out);
  }
  if (told < kBeyond.least_told || is_shadow(cells, outs, back)) return {};
  return {static_cast<double>(beyond) / told,
          farthest == 0 ? 0 : rings.first_px + static_cast<double>(farthest) * rings.width_px};
}

}  // namespace impactdic::circle
