#include "host/motion/measure_pairs.h"

#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

namespace impactdic::motion {
namespace {

// A pair whose windows at the rim were aimed worse than this is aimed again: well within the
// search, so that it costs no windows.
constexpr double kAimed_px = 2;
constexpr int kRounds = 3;

// A rotation vector in the camera's axes; of a flat ball x and y are 0.
struct Rotation {
  double x = 0, y = 0, z = 0;
};

Rotation found(const PairMotion& pair) {
  return {pair.motion.rot_x_rad, pair.motion.rot_y_rad, pair.motion.rot_rad};
}

Rotation guessed(const PairMotion& pair) {
  return {pair.guess_rot_x_rad, pair.guess_rot_y_rad, pair.guess_rot_rad};
}

void guess(PairMotion& pair, const Rotation& rotation) {
  pair.guess_rot_x_rad = rotation.x;
  pair.guess_rot_y_rad = rotation.y;
  pair.guess_rot_rad = rotation.z;
}

double between(const Rotation& a, const Rotation& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

bool well_aimed(const PairMotion& pair, double radius_px) {
  return pair.motion.ok && between(found(pair), guessed(pair)) * radius_px < kAimed_px;
}

// The rotation of the nearest pair that has one.
std::optional<Rotation> nearest_rotation(std::span<const PairMotion> pairs, std::size_t at) {
  for (std::size_t d = 0; d < pairs.size(); ++d) {
    if (at >= d && pairs[at - d].motion.ok) return found(pairs[at - d]);
    if (at + d < pairs.size() && pairs[at + d].motion.ok) return found(pairs[at + d]);
  }
  return std::nullopt;
}

// How some pairs are measured.
using Measure = std::function<void(std::span<PairMotion>)>;

// Measures those of `pairs` that `which` names.
void measure_some(const Measure& measure, std::span<PairMotion> pairs,
                  std::span<const std::size_t> which) {
  if (which.empty()) return;
  std::vector<PairMotion> some;
  some.reserve(which.size());
  for (const std::size_t i : which) some.push_back(std::move(pairs[i]));
  measure(some);
  for (std::size_t k = 0; k < which.size(); ++k) pairs[which[k]] = std::move(some[k]);
}

// Aims those that missed at what is known by now, until there is none to aim otherwise.
void aim_again(const Measure& measure, double radius_px, std::span<PairMotion> pairs,
               std::span<const std::size_t> candidates) {
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::size_t> again;
    std::vector<Rotation> guesses;
    for (const std::size_t i : candidates) {
      if (well_aimed(pairs[i], radius_px)) continue;
      const auto nearest = nearest_rotation(pairs, i);
      if (!nearest || between(*nearest, guessed(pairs[i])) < 1e-3) continue;
      again.push_back(i);
      guesses.push_back(*nearest);
    }
    if (again.empty()) return;
    for (std::size_t k = 0; k < again.size(); ++k) guess(pairs[again[k]], guesses[k]);
    measure_some(measure, pairs, again);
  }
}

}  // namespace

void measure_pairs(MotionEstimator& estimator, double radius_px, std::span<PairMotion> pairs) {
  if (pairs.empty()) return;
  if (pairs.size() > 2) {
    const std::array<std::size_t, 2> ends = {0, pairs.size() - 1};
    const Measure aiming = [&](std::span<PairMotion> some) { estimator.aim(some); };
    measure_some(aiming, pairs, ends);
    aim_again(aiming, radius_px, pairs, ends);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      guess(pairs[i], nearest_rotation(pairs, i).value_or(guessed(pairs[i])));
    }
  }
  estimator.measure(pairs);
  std::vector<std::size_t> all(pairs.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  aim_again([&](std::span<PairMotion> some) { estimator.measure(some); }, radius_px, pairs, all);
}

}  // namespace impactdic::motion
