#include "host/impact/evidence/path_evidence.h"

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "host/base/parallel/parallel_for.h"
#include "host/impact/evidence/path_fits.h"
#include "host/impact/evidence/path_shapes.h"

namespace impactdic::impact {
namespace {

// Frames before and behind a contact that are looked at: enough for any path to show its bends, and
// a long clip takes no longer.
constexpr std::size_t kMostFrames = 500;
// Samples below which a path tells nothing.
constexpr std::size_t kFewestSamples = 10;
// Odds beyond which nothing that a thorough search finds turns the verdict.
constexpr double kClear = 25;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

PathSpan near_contact(PathSpan span) {
  span.begin = std::max(span.begin, span.first - std::min(span.first, kMostFrames));
  span.end = std::min(span.end, span.last + kMostFrames);
  return span;
}

// How hard a broken path is sought.
enum class Search { kQuick, kThorough };

// The pulse whose ends suit the samples best: those guessed or, thoroughly, from there by steps
// that are halved.
struct Pulse {
  double score;
  std::array<double, 2> ends;
};
Pulse best_pulse(const Paths& paths, const PathFits& fits, const PathSpan& span, int waves,
                 bool with_step, Search search) {
  constexpr double kFirstStep = 0.2, kLeastStep = 0.003;  // of the guessed length
  constexpr double kShortest = 0.5;                       // frames
  const double length = static_cast<double>(span.last - span.first) + 1;
  const double begin = static_cast<double>(span.begin), end = static_cast<double>(span.end);
  std::array<double, 2> ends = {static_cast<double>(span.first), static_cast<double>(span.last)};
  const auto score = [&](const std::array<double, 2>& at) {
    if (at[0] < begin || at[1] > end || at[1] < at[0] + kShortest) return kInfinite;
    const Basis pulse = paths.pulse(at[0], at[1], waves, with_step);
    return fits.scores(pulse, pulse.size(), 1, 2)[0];
  };
  double best = score(ends);
  if (search == Search::kQuick) return {best, ends};
  for (double step = kFirstStep * length; step > kLeastStep * length;) {
    bool better = false;
    for (const auto& [first, last] :
         {std::array{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}, {1.0, -1.0}, {-1.0, 1.0}}) {
      const std::array next = {ends[0] + step * first, ends[1] + step * last};
      const double tried = score(next);
      if (!(tried < best)) continue;
      best = tried, ends = next, better = true;
    }
    if (!better) step /= 2;
  }
  return {best, ends};
}

// Of paths with an acceleration in the contact, the one that describes the samples best.
PathFit best_broken(const Paths& paths, const PathFits& fits, const PathSpan& span, Search search) {
  std::vector<Basis> tried;
  const double length = static_cast<double>(span.last - span.first);
  for (const double more : {std::max(0.5, length / 20), std::max(1.5, length / 5)}) {
    for (int pieces = 1; pieces <= 32 && (pieces == 1 || pieces <= length + 2 * more);
         pieces *= 2) {
      for (const bool constant : {true, false}) {
        if (!constant && pieces == 1) continue;
        tried.push_back(paths.broken(pieces, more, constant));
      }
    }
  }
  constexpr std::array kWaves = {1, 2, 3, 5, 8};
  std::vector<PathFit> found(tried.size() + 2 * kWaves.size());
  parallel_for(found.size(), 0, [&](std::size_t i) {
    if (i < tried.size()) {
      found[i] = fits.fit(tried[i]);
    } else {
      const std::size_t pulse = i - tried.size();
      const int waves = kWaves[pulse / 2];
      const bool with_step = pulse % 2 == 0;
      const auto [first, last] = best_pulse(paths, fits, span, waves, with_step, search).ends;
      if (last > first) found[i] = fits.fit(paths.pulse(first, last, waves, with_step), 2);
    }
  });
  return *std::min_element(found.begin(), found.end(),
                           [](const PathFit& a, const PathFit& b) { return a.score < b.score; });
}

// The least of each of several scores, about its least on a grid (Brent 1973, chapter 5).
// `scores`: all of them at a place of the grid; `score`: one of them at any place.
template <typename Scores, typename Score>
std::vector<double> least(const std::vector<double>& grid, const Scores& scores,
                          const Score& score) {
  constexpr int kBits = 20;
  std::vector<std::vector<double>> found(grid.size());
  parallel_for(grid.size(), 0, [&](std::size_t i) { found[i] = scores(grid[i]); });
  std::vector<double> least(found[0].size());
  parallel_for(least.size(), 0, [&](std::size_t k) {
    const auto best = std::min_element(found.begin(), found.end(),
                                       [k](const auto& a, const auto& b) { return a[k] < b[k]; });
    const auto at = static_cast<std::size_t>(best - found.begin());
    const double low = grid[at - std::min<std::size_t>(at, 1)];
    const double high = grid[std::min(at + 1, grid.size() - 1)];
    std::uintmax_t rounds = 40;
    const auto refined = boost::math::tools::brent_find_minima(
        [&](double place) { return score(place, k); }, low, high, kBits, rounds);
    least[k] = std::min((*best)[k], refined.second);
  });
  return least;
}

// The least score of circles with each number of harmonics, from a sixth of a turn in the span to
// four turns.
double best_circle(const Paths& paths, const PathFits& fits) {
  // No more unknowns than a third of the samples: the criterion is one of many samples.
  const int most_harmonics = std::clamp((static_cast<int>(fits.size()) / 3 - 3) / 2, 1, 6);
  constexpr double kFarthest = 0.1;  // turns: farther apart there are minima between
  std::vector<double> grid;          // radians a frame
  for (double turns = 1.0 / 6; turns < 4; turns += std::min(turns / 4, kFarthest)) {
    grid.push_back(2 * kPi * turns / paths.frames());
  }
  const std::vector<double> found = least(
      grid, [&](double rate) { return fits.scores(paths.circle(rate, most_harmonics), 4, 2, 1); },
      [&](double rate, std::size_t k) {
        return fits.fit(paths.circle(rate, static_cast<int>(k) + 1), 1).score;
      });
  return *std::min_element(found.begin(), found.end());
}

// Held or rolling, and then let go, or the reverse: another acceleration from some instant on.
double best_release(const Paths& paths, const PathFits& fits, const PathSpan& span) {
  constexpr int kPlaces = 24;
  std::vector<double> grid;
  for (int n = 0; n <= kPlaces; ++n) {
    grid.push_back(static_cast<double>(span.begin) + n * paths.frames() / kPlaces);
  }
  const auto score = [&](double at, std::size_t) { return fits.fit(paths.released(at), 1).score; };
  return least(
      grid, [&](double at) { return std::vector{score(at, 0)}; }, score)[0];
}

// The least score of all paths without a contact.
double best_smooth(const Paths& paths, const PathFits& fits, const PathSpan& span) {
  constexpr int kHighestDegree = 9, kMostPieces = 16;
  std::vector<std::function<double()>> families;
  families.emplace_back([&] { return best_circle(paths, fits); });  // those that last first
  families.emplace_back([&] { return best_release(paths, fits, span); });
  for (int pieces = 4; pieces <= kMostPieces && 4 * pieces <= paths.frames(); pieces *= 2) {
    families.emplace_back([&, pieces] { return fits.fit(paths.spline(pieces)).score; });
  }
  families.emplace_back([&] {
    const std::vector<double> found = fits.scores(paths.polynomial(kHighestDegree), 3, 1);
    return *std::min_element(found.begin(), found.end());
  });
  std::vector<double> scores(families.size());
  parallel_for(families.size(), 0, [&](std::size_t i) { scores[i] = families[i](); });
  return *std::min_element(scores.begin(), scores.end());
}

double odds_of(PathFits& fits, const PathSpan& span, Search search) {
  const Paths paths(span);
  for (int round = 0; round < 2; ++round) {
    fits.take_scatter(best_broken(paths, fits, span, search), span);
  }
  return (best_smooth(paths, fits, span) - best_broken(paths, fits, span, search).score) / 2;
}

double odds_by(PathSource source, const ImpactSeries& series, const PathSpan& span,
               double least_px) {
  PathFits fits(series, span, least_px, source);
  if (fits.size() < kFewestSamples) return 0;
  const double quick = odds_of(fits, span, Search::kQuick);
  return std::abs(quick) > kClear ? quick : odds_of(fits, span, Search::kThorough);
}

}  // namespace

double odds_of_contact(const ImpactSeries& series, const PathSpan& whole, double least_px) {
  const PathSpan span = near_contact(whole);
  const double both = odds_by(PathSource::kCentresAndSteps, series, span, least_px);
  if (series.from_circle || !(both > 0) || both > kClear) return both;
  // The rim of a pressed ball lies off by as much in all frames of a contact, and its centres bend
  // what the steps say.
  return std::max(both, odds_by(PathSource::kSteps, series, span, least_px));
}

ContactGuess sharpened(const ImpactSeries& series, ContactGuess guess) {
  const PathSpan span = near_contact({guess.first, guess.last, 0, series.size() - 1});
  const PathFits fits(series, span);
  if (fits.size() < kFewestSamples) return guess;
  const Paths paths(span);
  Pulse best{kInfinite, {}};
  for (const int waves : {1, 2, 3}) {
    const Pulse pulse = best_pulse(paths, fits, span, waves, false, Search::kThorough);
    if (pulse.score < best.score) best = pulse;
  }
  const double first = std::floor(best.ends[0]), last = std::ceil(best.ends[1]);
  if (best.score < kInfinite && last - first < static_cast<double>(guess.last - guess.first)) {
    guess.first = static_cast<std::size_t>(first);
    guess.last = static_cast<std::size_t>(last);
  }
  return guess;
}

}  // namespace impactdic::impact
