#include "host/dic/neighbours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "host/base/statistics.h"

namespace impactdic::dic {
namespace {

constexpr std::uint8_t kMostRounds = 200;  // each carries the front on by about a window
// A found window that is this far from what its neighbours say, beyond three times their own
// scatter, is suspect: a dense pattern's windows find each other's speckles.
constexpr float kSuspectPx = 0.5F;
constexpr std::size_t kFewestWitnesses = 3;

using Index = WindowPlaces::Index;
constexpr std::size_t kNearest = WindowPlaces::kNearest;

// What is known of a window; WindowPlaces knows that found ones are odd.
constexpr std::uint8_t kFound = 1, kLost = 2;
constexpr std::uint8_t kAgrees = 4;      // found, and the window before says nothing else
constexpr std::uint8_t kChallenged = 8;  // a suspect was sought again
constexpr std::uint8_t kJudged = 16;     // its texture was looked at
constexpr std::uint8_t kUnsettled = 32;  // stands in the list of those to be looked at

bool is_found(const WindowMotion& motion) {
  return motion.status == static_cast<idic_int>(WindowStatus::kOk);
}

bool has_no_texture(const WindowMotion& motion) {
  return motion.status == static_cast<idic_int>(WindowStatus::kNoTexture);
}

// Otherwise nothing was looked at.
bool is_in_view(const WindowMotion& motion) {
  return motion.status != static_cast<idic_int>(WindowStatus::kOutOfView);
}

static_assert(kNearest <= 6);  // UpperMedianOfSix
constexpr float kEndless = std::numeric_limits<float>::infinity();

// What a window's neighbours say of it: displacement and, of the turn, the tangent; one more for
// registers' sake.
typedef float Saying __attribute__((vector_size(16)));

struct Shift {
  float u, v;
};
bool differ(const Shift& shift, const WindowMotion& motion, float by) {
  return !(std::abs(shift.u - motion.u) <= by && std::abs(shift.v - motion.v) <= by);
}

}  // namespace

bool is_lost(const WindowMotion& motion) {
  const auto status = static_cast<WindowStatus>(motion.status);
  return status == WindowStatus::kLowCorrelation || status == WindowStatus::kAtSearchEdge ||
         status == WindowStatus::kNotConverged;
}

struct Neighbours::Proposals {
  std::vector<Window> windows;
  std::vector<WindowMotion> seeds, results;
  std::vector<Index> index;  // in its pair
  void clear() {
    windows.clear();
    seeds.clear();
    index.clear();
  }
};

// One pair's windows, and which of them are not settled.
class Neighbours::Front {
 public:
  // What another pair left behind is gone.
  void set(std::span<const Window> windows, std::shared_ptr<WindowPlaces> places,
           std::span<WindowMotion> motions, std::span<std::uint8_t> state) {
    windows_ = windows;
    motions_ = motions;
    state_ = state;
    places_ = std::move(places);
    changed_.assign(places_->bins(), 0);
    grown_.assign(places_->bins(), 0);
    unsettled_.resize(windows.size());
    std::size_t count = 0;
    for (Index i = 0; i < windows.size(); ++i) {
      const WindowMotion& motion = motions[i];
      std::uint8_t own = is_lost(motion) ? kLost | kUnsettled : 0;
      if (is_found(motion)) own = agrees(i) ? kFound | kAgrees : kFound | kUnsettled;
      state[i] = own;
      unsettled_[count] = i;
      count += (own & kUnsettled) != 0 ? 1 : 0;
    }
    unsettled_.resize(count);
  }

  // A window and its seed for every lost one that has found neighbours not seen before, and for
  // every suspect, once. Rounds count from 0.
  void propose(std::uint8_t round, Proposals& proposals) {
    begin_ = proposals.index.size();
    WindowPlaces::Nearest near;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < unsettled_.size(); ++k) {
      const Index i = unsettled_[k];
      std::uint8_t& own = state_[i];
      const bool is_lost = (own & (kFound | kLost)) == kLost;
      if (!is_lost && (own & (kFound | kAgrees | kChallenged)) != kFound) {
        own &= static_cast<std::uint8_t>(~kUnsettled);
        continue;
      }
      unsettled_[kept++] = i;
      const std::vector<std::uint8_t>& marks = is_lost ? grown_ : changed_;
      if (marks[places_->bin(i)] != round) continue;
      places_->find_nearest(i, state_, near);
      if (is_lost) {
        if (near.count > 0) seed(i, consensus(i, near), proposals);
        continue;
      }
      challenge(i, near, proposals);
    }
    unsettled_.resize(kept);
    end_ = proposals.index.size();
  }
  // Takes over what was found, and of a suspect what correlates better. Whether there was any.
  bool accept(std::uint8_t round, const Proposals& proposals) {
    bool any = false;
    for (std::size_t k = begin_; k < end_; ++k) {
      const Index i = proposals.index[k];
      const WindowMotion& result = proposals.results[k];
      WindowMotion& motion = motions_[i];
      std::uint8_t& own = state_[i];
      if (is_in_view(result)) own |= kJudged;
      const bool was_found = (own & kFound) != 0;
      if (!was_found && has_no_texture(result)) {
        motion.status = result.status;
        own &= static_cast<std::uint8_t>(~kLost);
      }
      if (!is_found(result)) continue;
      if (was_found && !(result.correlation > motion.correlation)) continue;
      motion = result;
      own = static_cast<std::uint8_t>((own & ~kLost) | kFound);
      places_->mark_near(i, round + 1, changed_);
      if (!was_found) places_->mark_near(i, round + 1, grown_);
      ask_window_before(i, round);
      if (i + 1 < windows_.size()) ask_window_before(i + 1, round);
      any = true;
    }
    return any;
  }

 private:
  // What window `from` says of the displacement at window `to`.
  Shift carried(Index from, Index to) const {
    const WindowMotion& m = motions_[from];
    const auto dx = static_cast<float>(places_->dx(from, to));
    const auto dy = static_cast<float>(places_->dy(from, to));
    return {m.u + m.ux * dx + m.uy * dy, m.v + m.vx * dx + m.vy * dy};
  }

  // Whether the window before window i says much the same of it.
  bool agrees(Index i) const {
    return i > 0 && is_found(motions_[i - 1]) &&
           !differ(carried(i - 1, i), motions_[i], kSuspectPx);
  }

  // When one of the two has changed. Where the window before agrees, as nearly all do, no one else
  // is asked.
  void ask_window_before(Index i, std::uint8_t round) {
    std::uint8_t& own = state_[i];
    if ((own & kFound) == 0) return;
    own = static_cast<std::uint8_t>((own & ~kAgrees) | (agrees(i) ? kAgrees : 0));
    if ((own & kAgrees) != 0) return;
    changed_[places_->bin(i)] = round + 1;
    if ((own & kUnsettled) == 0) unsettled_.push_back(i);
    own |= kUnsettled;
  }

  // The median of what those near say of window i.
  Saying consensus(Index i, const WindowPlaces::Nearest& near) const {
    UpperMedianOfSix<Saying> all(Saying{} + kEndless);
    for (std::size_t k = 0; k < near.count; ++k) {
      const WindowMotion& m = motions_[near.index[k]];
      const Shift shift = carried(near.index[k], i);
      all.add(Saying{shift.u, shift.v, (m.uy - m.vx) / (2 + m.ux + m.vy), 0});
    }
    return all.median();
  }

  // Proposes a found window that is suspect.
  void challenge(Index i, WindowPlaces::Nearest& near, Proposals& proposals) {
    const auto begin = near.index.begin(), end = begin + static_cast<std::ptrdiff_t>(near.count);
    near.count = static_cast<std::size_t>(std::remove(begin, end, i) - begin);
    if (near.count < kFewestWitnesses) return;
    // Most of them agree: so does the median.
    std::size_t agree = 0;
    for (std::size_t k = 0; k < near.count; ++k) {
      agree += differ(carried(near.index[k], i), motions_[i], kSuspectPx) ? 0 : 1;
    }
    if (2 * agree > near.count) return;
    const Saying middle = consensus(i, near);
    UpperMedianOfSix<float> apart(kEndless);
    for (std::size_t k = 0; k < near.count; ++k) {
      const Shift shift = carried(near.index[k], i);
      apart.add(std::max(std::abs(shift.u - middle[0]), std::abs(shift.v - middle[1])));
    }
    if (!differ({middle[0], middle[1]}, motions_[i], kSuspectPx + 3 * apart.median())) return;
    state_[i] |= kChallenged;
    seed(i, middle, proposals);
  }

  void seed(Index i, const Saying& said, Proposals& proposals) const {
    proposals.index.push_back(i);
    proposals.windows.push_back(windows_[i]);
    proposals.windows.back().guess_rot_rad = std::atan(said[2]);
    proposals.seeds.push_back(seed_at(said[0], said[1]));
  }

  std::span<const Window> windows_;
  std::span<WindowMotion> motions_;
  std::span<std::uint8_t> state_;
  std::shared_ptr<WindowPlaces> places_;
  std::vector<Index> unsettled_;  // lost, or found and not as the window before says
  // Of every bin, the last round before which a window near it changed, or was found.
  std::vector<std::uint8_t> changed_, grown_;
  std::size_t begin_ = 0, end_ = 0;  // of the last proposals
};

Neighbours::Neighbours() : proposals_(std::make_unique<Proposals>()) {}
Neighbours::~Neighbours() = default;

void Neighbours::start_fronts(std::span<const Window> windows, int window_px,
                              std::span<WindowMotion> motions) {
  pairs_ = 0;
  proposals_->clear();
  state_.resize(windows.size());
  for (std::size_t begin = 0, end; begin < windows.size(); begin = end) {
    // Mostly, all pairs have the same grid.
    if (!places_ || !places_->lead(windows.subspan(begin), window_px)) {
      for (end = begin; end < windows.size() && windows[end].first == windows[begin].first &&
                        windows[end].second == windows[begin].second;) {
        ++end;
      }
      places_ = std::make_shared<WindowPlaces>(windows.subspan(begin, end - begin), window_px);
    }
    const std::size_t count = places_->size();
    end = begin + count;
    if (fronts_.size() == pairs_) fronts_.emplace_back();
    Front& front = fronts_[pairs_++];
    front.set(windows.subspan(begin, count), places_, motions.subspan(begin, count),
              std::span(state_).subspan(begin, count));
    // While what it looks at is in the cache.
    front.propose(0, *proposals_);
  }
}

void Neighbours::refine_lost(std::span<const Window> windows, int window_px,
                             const RefineWindows& refine, std::span<WindowMotion> motions) {
  start_fronts(windows, window_px, motions);
  const auto fronts = std::span(fronts_).first(pairs_);
  for (std::uint8_t round = 0; !proposals_->index.empty(); ++round) {
    proposals_->results.resize(proposals_->index.size());
    refine(proposals_->windows, proposals_->seeds, proposals_->results);
    bool any = false;
    for (Front& front : fronts) any = front.accept(round, *proposals_) || any;
    if (!any || round + 1 == kMostRounds) return;
    proposals_->clear();
    for (Front& front : fronts) front.propose(round + 1, *proposals_);
  }
}

void Neighbours::judge_lost(std::span<const Window> windows, std::span<const std::size_t> which,
                            const RefineWindows& refine, std::span<WindowMotion> motions) {
  std::vector<std::size_t> index;
  Proposals& proposals = *proposals_;
  proposals.clear();
  for (const std::size_t i : which) {
    if ((state_[i] & (kLost | kJudged)) != kLost) continue;
    index.push_back(i);
    proposals.windows.push_back(windows[i]);
    proposals.seeds.push_back(motions[i]);
  }
  if (index.empty()) return;
  proposals.results.resize(index.size());
  refine(proposals.windows, proposals.seeds, proposals.results);
  for (std::size_t k = 0; k < index.size(); ++k) {
    if (has_no_texture(proposals.results[k]))
      motions[index[k]].status = proposals.results[k].status;
  }
}

}  // namespace impactdic::dic
