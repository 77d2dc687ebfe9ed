#include "sim/speckle/noise.h"

#include <impactdic/units.h>

#include <cmath>

namespace impactdic::sim::speckle {
namespace {

// SplitMix64 (Steele, Lea & Flood 2014): a counter through a mixing function.
std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15ULL;

}  // namespace

void add_row_noise(std::span<double> row, double sigma, std::uint64_t seed, std::int64_t frame,
                   int row_index) {
  std::uint64_t state = mix(seed + kGolden);
  state = mix(state + kGolden * static_cast<std::uint64_t>(frame + 1));
  state = mix(state + kGolden * static_cast<std::uint64_t>(row_index + 1));
  // Box & Muller (1958), two deviates from two uniforms in (0, 1].
  for (std::size_t x = 0; x < row.size(); x += 2) {
    const double u = static_cast<double>((mix(state += kGolden) >> 11) + 1) * 0x1p-53;
    const double angle = 2 * kPi * static_cast<double>(mix(state += kGolden) >> 11) * 0x1p-53;
    const double length = sigma * std::sqrt(-2 * std::log(u));
    row[x] += length * std::cos(angle);
    if (x + 1 < row.size()) row[x + 1] += length * std::sin(angle);
  }
}

}  // namespace impactdic::sim::speckle
