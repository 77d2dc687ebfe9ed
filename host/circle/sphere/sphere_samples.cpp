// Samples of a sphere's inside, eight at a time.
#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "host/base/statistics.h"
#include "host/circle/rim/lanes.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/settings/sphere.h"
#include "host/circle/sphere/sphere_light.h"

namespace impactdic::circle {
namespace {

static_assert(kRings == kLanes);
constexpr int kOutermost = 2;  // last of the samples that are nearest to the rim

// The directions, which are the same for every sphere.
struct Side {
  float cos, sin;
  int sector;
};
const std::array<Side, kDirections>& sides() {
  static const std::array<Side, kDirections> kSides = [] {
    std::array<Side, kDirections> all{};
    for (int i = 0; i < kDirections; ++i) {
      const double angle = (i + 0.5) * 2 * kPi / kDirections - kPi / 4;
      Side& side = all[i];
      side.cos = static_cast<float>(std::cos(angle));
      side.sin = static_cast<float>(std::sin(angle));
      const double turn = std::atan2(side.sin, side.cos) / (2 * kPi) + 0.125;
      side.sector = static_cast<int>((turn - std::floor(turn)) * kLevelSectors);
    }
    return all;
  }();
  return kSides;
}

// As Sampler::bilinear, to the bit, at eight points.
template <typename T>
[[gnu::always_inline]] inline void bilinear(const ImageView<const T>& picture, const Lanes& x,
                                            const Lanes& y, Lanes& level) {
  const IntLanes ix = __builtin_convertvector(x, IntLanes);
  const IntLanes iy = __builtin_convertvector(y, IntLanes);
  const Lanes fx = x - __builtin_convertvector(ix, Lanes);
  const Lanes fy = y - __builtin_convertvector(iy, Lanes);
  IntLanes corner[4];
  for (int k = 0; k < kLanes; ++k) {
    const T* a = picture.data + iy[k] * picture.pitch + ix[k];
    const T* b = a + picture.pitch;
    corner[0][k] = a[0];
    corner[1][k] = a[1];
    corner[2][k] = b[0];
    corner[3][k] = b[1];
  }
  const auto as_float = [](const IntLanes& v) { return __builtin_convertvector(v, Lanes); };
  const Lanes top = as_float(corner[0]) + fx * as_float(corner[1] - corner[0]);
  const Lanes bottom = as_float(corner[2]) + fx * as_float(corner[3] - corner[2]);
  level = top + fy * (bottom - top);
}

// The samples of one direction; returns how far the ball's outermost ones rise above what is seen
// outside.
template <typename T>
float sample_along(const ImageView<const T>& picture, const Rim& rim, float sign, float outside,
                   float reach, float uneven, const Lanes& share, SphereSamples::Direction& d) {
  const auto cx = static_cast<float>(rim.cx), cy = static_cast<float>(rim.cy);
  const auto level = [&](const Lanes& at, Lanes& out) {
    bilinear(picture, cx + at * reach * d.cos, cy + at * reach * d.sin, out);
    out *= sign;
  };
  // Where ink ends the level is neither paint's nor ink's.
  const float beside = kSphere.beside_px / static_cast<float>(rim.r);
  Lanes here, inwards, outwards;
  level(share, here);
  level(share - beside, inwards);
  level(share + beside, outwards);
  inwards -= here;
  outwards -= here;
  const IntLanes flat =
      (inwards < uneven) & (inwards > -uneven) & (outwards < uneven) & (outwards > -uneven);
  const Lanes kept = flat ? here : Lanes{} + kNoLevel;
  std::memcpy(d.level.data(), &kept, sizeof(kept));
  std::memcpy(d.seen.data(), &here, sizeof(here));
  float brightest = kNoLevel;
  for (int k = 0; k <= kOutermost; ++k) brightest = std::max(brightest, here[k]);
  const Sampler<T> sampler(picture);
  return brightest -
         sign * sampler.bilinear(cx + outside * reach * d.cos, cy + outside * reach * d.sin);
}

template <typename T>
void sample_inside(ImageView<const T> picture, const Rim& rim, float sign, double step_px,
                   float noise, SphereSamples& samples) {
  const Sampler<T> sampler(picture);
  const auto outside = static_cast<float>(1 + kOutside * step_px / rim.r);
  const float uneven = kSphere.uneven_noise * noise + kSphere.uneven_least;
  samples.directions.clear();
  std::vector<float>& rises = samples.rises;
  rises.clear();
  const int layers = static_cast<int>(samples.x.size());
  for (int i = 0; i < layers * kDirections; ++i) {
    const int layer = i % layers;
    const Side& side = sides()[i / layers];
    SphereSamples::Direction d{side.cos, side.sin, layer, side.sector, {}, {}};
    const auto reach = static_cast<float>(
        rim.radius_at(d.cos * d.cos - d.sin * d.sin, 2.0 * static_cast<double>(d.cos * d.sin)));
    const auto x = [&](float share) { return static_cast<float>(rim.cx) + share * reach * d.cos; };
    const auto y = [&](float share) { return static_cast<float>(rim.cy) + share * reach * d.sin; };
    const float innermost = samples.x[layer][kRings - 1];
    if (!sampler.inside(x(outside), y(outside), kSphere.margin_px) ||
        !sampler.inside(x(innermost), y(innermost), kSphere.margin_px)) {
      continue;
    }
    Lanes share;
    load(samples.x[layer].data(), share);
    rises.push_back(sample_along(picture, rim, sign, outside, reach, uneven, share, d));
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

}  // namespace

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
    sample_inside(frame.u8.view(), rim, sign_of(polarity), step_px, static_cast<float>(noise),
                  samples);
  } else {
    sample_inside(frame.u16.view(), rim, sign_of(polarity), step_px, static_cast<float>(noise),
                  samples);
  }
}

}  // namespace impactdic::circle
