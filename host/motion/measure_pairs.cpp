#include "host/motion/measure_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

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

// The nearest pair that has a rotation.
const PairMotion* nearest_measured(std::span<const PairMotion> pairs, std::size_t at) {
  for (std::size_t d = 0; d < pairs.size(); ++d) {
    if (at >= d && pairs[at - d].motion.ok) return &pairs[at - d];
    if (at + d < pairs.size() && pairs[at + d].motion.ok) return &pairs[at + d];
  }
  return nullptr;
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
    std::vector<std::pair<Rotation, bool>> guesses;
    for (const std::size_t i : candidates) {
      if (well_aimed(pairs[i], radius_px)) continue;
      const PairMotion* known = nearest_measured(pairs, i);
      if (!known || between(found(*known), guessed(pairs[i])) < 1e-3) continue;
      again.push_back(i);
      guesses.emplace_back(found(*known), known->sought);
    }
    if (again.empty()) return;
    for (std::size_t k = 0; k < again.size(); ++k) {
      guess(pairs[again[k]], guesses[k].first);
      pairs[again[k]].sought = guesses[k].second;
    }
    measure_some(measure, pairs, again);
  }
}

constexpr double kDiffer = 0.25, kLeast_rad = 0.02;  // of turns that are alike
constexpr std::size_t kBeside = 4;                   // pairs on either side that have a say

double size(const Rotation& turn) { return between(turn, {}); }

bool is_alike(const PairMotion& a, const PairMotion& b) {
  return between(found(a), found(b)) < kLeast_rad + kDiffer * size(found(a));
}

// Whether the ball turned by any part or multiple of what it does in `b`: between them a picture
// may be lost, or be there twice.
bool is_along(const PairMotion& a, const PairMotion& b) {
  const Rotation turn = found(a), axis = found(b);
  const double square = std::pow(size(axis), 2);
  if (!(square > 0)) return true;
  const double times =
      std::max(0.0, (turn.x * axis.x + turn.y * axis.y + turn.z * axis.z) / square);
  const Rotation along = {times * axis.x, times * axis.y, times * axis.z};
  return between(turn, along) < kLeast_rad + kDiffer * size(turn);
}

// The nearest measured pairs before (-1) or behind (1) pair `i`.
std::vector<const PairMotion*> nearest(std::span<const PairMotion> pairs, std::size_t i, int side) {
  std::vector<const PairMotion*> found;
  auto k = static_cast<std::ptrdiff_t>(i) + side;
  for (; k >= 0 && k < static_cast<std::ptrdiff_t>(pairs.size()) && found.size() < kBeside;
       k += side) {
    const PairMotion& pair = pairs[static_cast<std::size_t>(k)];
    if (pair.motion.ok) found.push_back(&pair);
  }
  return found;
}

// Few marks, or marks that are alike, may be led onto each other by another turn than the ball's.
// No ball turns so in one frame and otherwise in those beside it. One that was looked for
// everywhere, or from such a one, must be borne out by more than it contradicts.
bool is_lone(std::span<const PairMotion> pairs, std::size_t i) {
  const auto before = nearest(pairs, i, -1), behind = nearest(pairs, i, 1);
  const auto differs = [&](const PairMotion* other) {
    return !is_alike(pairs[i], *other) && !is_along(pairs[i], *other);
  };
  if (!before.empty() && !behind.empty() && is_alike(*before[0], *behind[0])) {
    return differs(before[0]) && differs(behind[0]);
  }
  if (!pairs[i].sought) return false;
  std::size_t alike = 0, others = 0;
  for (const auto* side : {&before, &behind}) {
    for (const PairMotion* pair : *side) ++(is_alike(pairs[i], *pair) ? alike : others);
  }
  return others > 0 && alike <= others && alike < kBeside;  // behind an impact it goes on so
}

void drop_lone_turns(std::span<PairMotion> pairs) {
  std::vector<std::size_t> lone;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].motion.ok && is_lone(pairs, i)) lone.push_back(i);
  }
  for (const std::size_t i : lone) {
    pairs[i].motion.ok = false;
    pairs[i].status = TrackStatus::kLowCorrelation;
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
      const PairMotion* known = nearest_measured(pairs, i);
      if (!known) continue;
      guess(pairs[i], found(*known));
      pairs[i].sought = known->sought;
    }
  }
  estimator.measure(pairs);
  std::vector<std::size_t> all(pairs.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  aim_again([&](std::span<PairMotion> some) { estimator.measure(some); }, radius_px, pairs, all);
  drop_lone_turns(pairs);
}

}  // namespace impactdic::motion
