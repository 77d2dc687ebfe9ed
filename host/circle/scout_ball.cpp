#include "host/circle/scout_ball.h"

#include <impactdic/error.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/base/statistics.h"
#include "host/circle/settings/search.h"

namespace impactdic::circle {
namespace {

struct Sighting {
  double radius_px = 0;
  double rim_fraction = 0;
  // Length of rim seen: a blob inside the ball is round too, but small.
  double score() const { return rim_fraction * radius_px; }
};

Sighting sight(FrameSource& source, std::int64_t index, const Roi& roi,
               const CircleOptions& options) {
  Frame whole, frame;
  try {
    source.read(index, whole);
  } catch (const Error&) {
    return {};  // the run itself will say so, when it has measured the frames before
  }
  crop(whole, roi, frame);
  const auto found = find_ball(frame, options);
  if (!found) return {};
  CirclePrior prior;
  prior.predicted = *found;
  prior.centre_sd_px = kScout.found_sd_px;
  prior.learn = false;  // roughly will do
  const CircleFit fit = measure_circle(frame, prior, options);
  if (fit.status != CircleStatus::kOk || fit.rim_fraction < kScout.well_seen) return {};
  return {fit.circle.r_px, fit.rim_fraction};
}

bool same_radius(const Sighting& a, const Sighting& b) {
  return std::abs(a.radius_px - b.radius_px) < kScout.same_radius * b.radius_px;
}

// Those that agree with the sighting that most rim speaks for.
std::vector<Sighting> agreed(const std::vector<Sighting>& sightings) {
  std::vector<Sighting> best;
  double best_score = 0;
  for (const Sighting& centre : sightings) {
    std::vector<Sighting> same;
    double score = 0;
    for (const Sighting& other : sightings) {
      if (other.radius_px > 0 && same_radius(other, centre)) {
        same.push_back(other);
        score += other.score();
      }
    }
    if (score > best_score) {
      best_score = score;
      best = std::move(same);
    }
  }
  return best;
}

}  // namespace

std::optional<double> scout_radius_px(FrameSource& source, const FrameRange& range, const Roi& roi,
                                      const CircleOptions& options) {
  std::vector<Sighting> sightings;
  std::vector<std::int64_t> sighted;
  std::vector<Sighting> best;
  for (std::int64_t wanted = kScout.first_frames; wanted <= kScout.most_frames; wanted *= 2) {
    const std::int64_t n = std::min(wanted, range.count());
    std::vector<std::int64_t> frames;
    for (std::int64_t k = 0; k < n; ++k) {
      const std::int64_t index = range.at((2 * k + 1) * range.count() / (2 * n));
      if (std::find(sighted.begin(), sighted.end(), index) == sighted.end()) {
        frames.push_back(index);
      }
    }
    const std::size_t before = sightings.size();
    sightings.resize(before + frames.size());
    tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t k) {
      sightings[before + k] = sight(source, frames[k], roi, options);
    });
    sighted.insert(sighted.end(), frames.begin(), frames.end());
    best = agreed(sightings);
    if (static_cast<int>(best.size()) >= kScout.agree || n == range.count()) break;
  }
  if (best.empty()) return std::nullopt;
  std::vector<double> radii_px;
  for (const Sighting& one : best) radii_px.push_back(one.radius_px);
  return upper_median(std::move(radii_px));
}

}  // namespace impactdic::circle
