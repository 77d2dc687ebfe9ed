#include "host/dic/neighbours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

namespace impactdic {
namespace {

constexpr std::size_t kNearest = 6;
constexpr int kMostRounds = 200;  // each carries the front on by about a window
// A found window that is this far from what its neighbours say, beyond three times their own
// scatter, is suspect: a dense pattern's windows find each other's speckles.
constexpr float kSuspectPx = 0.5F;
constexpr std::size_t kFewestWitnesses = 3;

bool is_found(const WindowMotion& motion) {
  return motion.status == static_cast<idic_int>(WindowStatus::ok);
}

bool has_no_texture(const WindowMotion& motion) {
  return motion.status == static_cast<idic_int>(WindowStatus::no_texture);
}

// Otherwise nothing was looked at.
bool is_in_view(const WindowMotion& motion) {
  return motion.status != static_cast<idic_int>(WindowStatus::out_of_view);
}

bool is_lost(const WindowMotion& motion) {
  const auto status = static_cast<WindowStatus>(motion.status);
  return status == WindowStatus::low_correlation || status == WindowStatus::at_search_edge ||
         status == WindowStatus::not_converged;
}

// Up to kNearest numbers.
class Few {
 public:
  Few() { values_.fill(std::numeric_limits<float>::infinity()); }
  void add(float value) { values_[count_++] = value; }
  // By exchanges that need no branches: which of them are needed is chance.
  float median() {
    static_assert(kNearest == 6);
    for (const auto& [low, high] : kNetwork) {
      const float a = values_[low], b = values_[high];
      values_[low] = std::min(a, b);
      values_[high] = std::max(a, b);
    }
    return values_[count_ / 2];
  }

 private:
  // Sorts six (Knuth, The Art of Computer Programming, volume 3, section 5.3.4).
  static constexpr std::pair<int, int> kNetwork[] = {{0, 5}, {1, 3}, {2, 4}, {1, 2},
                                                     {3, 4}, {0, 3}, {2, 5}, {0, 1},
                                                     {2, 3}, {4, 5}, {1, 2}, {3, 4}};
  std::array<float, kNearest> values_;
  std::size_t count_ = 0;
};

// What window `from` says of the displacement at window `at`.
struct Shift {
  float u, v;
};
Shift carried(const Window& from, const WindowMotion& motion, const Window& at) {
  const auto dx = static_cast<float>(at.x0 - from.x0), dy = static_cast<float>(at.y0 - from.y0);
  return {motion.u + motion.ux * dx + motion.uy * dy, motion.v + motion.vx * dx + motion.vy * dy};
}

}  // namespace

// The windows of a grid by place: square bins, as wide as a window. Bins that lie side by side
// follow each other.
class Neighbours::Bins {
 public:
  Bins(std::span<const Window> windows, int side) : side_(side) {
    int x1 = x0_ = windows[0].x0, y1 = y0_ = windows[0].y0;
    for (const Window& window : windows) {
      x0_ = std::min(x0_, window.x0);
      y0_ = std::min(y0_, window.y0);
      x1 = std::max(x1, window.x0);
      y1 = std::max(y1, window.y0);
    }
    across_ = (x1 - x0_) / side + 1;
    down_ = (y1 - y0_) / side + 1;
    begin_.assign(static_cast<std::size_t>(across_ * down_) + 1, 0);
    for (const Window& window : windows) ++begin_[bin(window) + 1];
    for (std::size_t k = 1; k < begin_.size(); ++k) begin_[k] += begin_[k - 1];
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    entries_.resize(windows.size());
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const int x = windows[i].x0 - x0_, y = windows[i].y0 - y0_;
      places_.push_back(next[bin(windows[i])]++);
      entries_[places_[i]] = {x, y, i};
    }
  }

  // Whether these windows stand to each other as those that the bins were made of.
  bool fit(std::span<const Window> windows, int side) const {
    if (windows.size() != places_.size() || side != side_) return false;
    const int x0 = windows[0].x0 - entries_[places_[0]].x;
    const int y0 = windows[0].y0 - entries_[places_[0]].y;
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const Entry& entry = entries_[places_[i]];
      if (windows[i].x0 - x0 != entry.x || windows[i].y0 - y0 != entry.y) return false;
    }
    return true;
  }

  struct Entry {
    int x, y;           // from the grid's first column and row
    std::size_t index;  // of the window
  };
  // By place.
  const Entry& entry(std::size_t place) const { return entries_[place]; }
  // Of window `index`.
  std::size_t place(std::size_t index) const { return places_[index]; }

  // Calls visit(first, last) for the rows of places in the 3 × 3 bins about window `index`.
  template <typename Visit>
  void each_row_near(std::size_t index, const Visit& visit) const {
    const Entry& entry = entries_[places_[index]];
    const int column = entry.x / side_, row = entry.y / side_;
    const int left = std::max(0, column - 1), right = std::min(across_ - 1, column + 1);
    for (int j = std::max(0, row - 1); j <= std::min(down_ - 1, row + 1); ++j) {
      visit(begin_[static_cast<std::size_t>(j * across_ + left)],
            begin_[static_cast<std::size_t>(j * across_ + right) + 1]);
    }
  }

 private:
  std::size_t bin(const Window& window) const {
    return static_cast<std::size_t>((window.y0 - y0_) / side_ * across_ +
                                    (window.x0 - x0_) / side_);
  }
  int side_, x0_, y0_, across_, down_;
  std::vector<std::size_t> begin_, places_;
  std::vector<Entry> entries_;
};

// One pair's windows, and which of them have other neighbours since they were last looked at.
class Neighbours::Front {
 public:
  // What another pair left behind is gone.
  void set(std::span<const Window> windows, std::shared_ptr<const Bins> bins,
           std::span<WindowMotion> motions, std::span<std::uint8_t> judged) {
    windows_ = windows;
    motions_ = motions;
    judged_ = judged;
    bins_ = std::move(bins);
    found_.resize(windows.size());
    tried_.assign(windows.size(), 0);
    challenged_.assign(windows.size(), 0);
    stale_.assign(windows.size(), 1);
    for (std::size_t i = 0; i < windows.size(); ++i) {
      found_[bins_->place(i)] = is_found(motions[i]) ? 1 : 0;
    }
  }

  // A window and its seed for every lost one that has found neighbours not seen before, and for
  // every suspect, once.
  void propose() {
    proposed_.clear();
    proposed_windows.clear();
    seeds.clear();
    for (std::size_t i = 0; i < windows_.size(); ++i) {
      if (stale_[i] == 0) continue;
      stale_[i] = 0;
      if (is_found(motions_[i])) {
        if (challenged_[i] != 0 || !is_suspect(i)) continue;
        challenged_[i] = 1;
      } else {
        if (!is_lost(motions_[i])) continue;
        const std::size_t found = gather(i);
        if (found <= tried_[i]) continue;
        tried_[i] = found;
      }
      seed(i);
    }
  }
  // Takes over what was found, and of a suspect what correlates better. Whether there was any.
  bool accept(std::span<const WindowMotion> results) {
    bool any = false;
    for (std::size_t k = 0; k < proposed_.size(); ++k) {
      WindowMotion& motion = motions_[proposed_[k]];
      judged_[proposed_[k]] |= is_in_view(results[k]) ? 1 : 0;
      if (is_lost(motion) && has_no_texture(results[k])) motion.status = results[k].status;
      if (!is_found(results[k])) continue;
      if (is_found(motion) && !(results[k].correlation > motion.correlation)) continue;
      motion = results[k];
      found_[bins_->place(proposed_[k])] = 1;
      put_in_doubt(proposed_[k]);
      any = true;
    }
    return any;
  }

  // What `propose` proposes.
  std::vector<Window> proposed_windows;
  std::vector<WindowMotion> seeds;

 private:
  struct Neighbour {
    int distance2;
    std::size_t index;
    bool operator<(const Neighbour& other) const {
      return distance2 != other.distance2 ? distance2 < other.distance2 : index < other.index;
    }
  };

  // Whose neighbour this one is, and the window behind it, which asks it first (is_suspect).
  void put_in_doubt(std::size_t i) {
    bins_->each_row_near(i, [&](std::size_t first, std::size_t last) {
      for (std::size_t place = first; place < last; ++place) stale_[bins_->entry(place).index] = 1;
    });
    if (i + 1 < stale_.size()) stale_[i + 1] = 1;
  }

  // The nearest found windows into `near_`, the nearest first; returns how many there are at all.
  std::size_t gather(std::size_t i) {
    near_count_ = 0;
    std::size_t found = 0;
    const Bins::Entry& own = bins_->entry(bins_->place(i));
    bins_->each_row_near(i, [&](std::size_t first, std::size_t last) {
      for (std::size_t place = first; place < last; ++place) {
        if (found_[place] == 0) continue;
        ++found;
        const Bins::Entry& entry = bins_->entry(place);
        const int dx = entry.x - own.x, dy = entry.y - own.y;
        put_near({dx * dx + dy * dy, entry.index});
      }
    });
    return found;
  }

  void put_near(const Neighbour& neighbour) {
    if (near_count_ == kNearest && !(neighbour < near_[kNearest - 1])) return;
    std::size_t at = near_count_ < kNearest ? near_count_++ : kNearest - 1;
    for (; at > 0 && neighbour < near_[at - 1]; --at) near_[at] = near_[at - 1];
    near_[at] = neighbour;
  }

  std::span<const Neighbour> near() const { return {near_.data(), near_count_}; }

  // Where the windows in `near_` say that window i went, each component's median; and the median
  // distance of what they say from that.
  Shift consensus(std::size_t i, float* scatter) const {
    std::array<Shift, kNearest> shifts;
    Few u, v, apart;
    for (std::size_t k = 0; k < near_count_; ++k) {
      const std::size_t index = near_[k].index;
      shifts[k] = carried(windows_[index], motions_[index], windows_[i]);
      u.add(shifts[k].u);
      v.add(shifts[k].v);
    }
    const Shift middle = {u.median(), v.median()};
    for (std::size_t k = 0; k < near_count_; ++k) {
      apart.add(std::max(std::abs(shifts[k].u - middle.u), std::abs(shifts[k].v - middle.v)));
    }
    *scatter = apart.median();
    return middle;
  }

  // Leaves the window's neighbours in `near_` if it is.
  bool is_suspect(std::size_t i) {
    // Where the window before agrees, as nearly all do, no one else is asked.
    const auto differs = [&](const Shift& shift, float by) {
      return !(std::abs(shift.u - motions_[i].u) <= by && std::abs(shift.v - motions_[i].v) <= by);
    };
    if (i > 0 && is_found(motions_[i - 1]) &&
        !differs(carried(windows_[i - 1], motions_[i - 1], windows_[i]), kSuspectPx)) {
      return false;
    }
    gather(i);
    const auto end =
        std::remove_if(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(near_count_),
                       [&](const Neighbour& neighbour) { return neighbour.index == i; });
    near_count_ = static_cast<std::size_t>(end - near_.begin());
    if (near_count_ < kFewestWitnesses) return false;
    float scatter = 0;
    const Shift shift = consensus(i, &scatter);
    return differs(shift, kSuspectPx + 3 * scatter);
  }

  void seed(std::size_t i) {
    float scatter = 0;
    const Shift shift = consensus(i, &scatter);
    Few turns;  // their tangents: one angle is worked out instead of six
    for (const Neighbour& neighbour : near()) {
      const WindowMotion& m = motions_[neighbour.index];
      turns.add((m.uy - m.vx) / (2 + m.ux + m.vy));
    }
    Window window = windows_[i];
    window.guess_rot_rad = std::atan(turns.median());
    WindowMotion start{};
    start.u = shift.u;
    start.v = shift.v;
    start.correlation = start.peak_ratio = std::numeric_limits<float>::quiet_NaN();
    start.status = static_cast<idic_int>(WindowStatus::ok);
    proposed_.push_back(i);
    proposed_windows.push_back(window);
    seeds.push_back(start);
  }

  std::span<const Window> windows_;
  std::span<WindowMotion> motions_;
  std::span<std::uint8_t> judged_;
  std::shared_ptr<const Bins> bins_;
  std::vector<std::uint8_t> found_;  // by place
  std::vector<std::size_t> tried_, proposed_;
  std::vector<std::uint8_t> challenged_, stale_;
  std::array<Neighbour, kNearest> near_;
  std::size_t near_count_ = 0;
};

Neighbours::Neighbours() = default;
Neighbours::~Neighbours() = default;

void Neighbours::set_fronts(std::span<const Window> windows, int window_px,
                            std::span<WindowMotion> motions) {
  pairs_ = 0;
  judged_.assign(windows.size(), 0);
  for (std::size_t begin = 0, end; begin < windows.size(); begin = end) {
    for (end = begin; end < windows.size() && windows[end].first == windows[begin].first &&
                      windows[end].second == windows[begin].second;) {
      ++end;
    }
    // Mostly, all pairs have the same grid.
    const auto own = windows.subspan(begin, end - begin);
    if (!bins_ || !bins_->fit(own, window_px)) bins_ = std::make_shared<const Bins>(own, window_px);
    if (fronts_.size() == pairs_) fronts_.emplace_back();
    fronts_[pairs_++].set(own, bins_, motions.subspan(begin, end - begin),
                          std::span(judged_).subspan(begin, end - begin));
  }
}

void Neighbours::refine_lost(std::span<const Window> windows, int window_px,
                             const RefineWindows& refine, std::span<WindowMotion> motions) {
  set_fronts(windows, window_px, motions);
  const auto fronts = std::span(fronts_).first(pairs_);
  bool any = true;
  for (int round = 0; round < kMostRounds && any; ++round) {
    for (Front& front : fronts) front.propose();
    windows_.clear();
    seeds_.clear();
    for (const Front& front : fronts) {
      windows_.insert(windows_.end(), front.proposed_windows.begin(), front.proposed_windows.end());
      seeds_.insert(seeds_.end(), front.seeds.begin(), front.seeds.end());
    }
    if (windows_.empty()) return;
    results_.resize(windows_.size());
    refine(windows_, seeds_, results_);
    any = false;
    std::size_t at = 0;
    for (Front& front : fronts) {
      const std::size_t count = front.seeds.size();
      any = front.accept(std::span(results_).subspan(at, count)) || any;
      at += count;
    }
  }
}

void Neighbours::judge_lost(std::span<const Window> windows, std::span<const std::size_t> which,
                            const RefineWindows& refine, std::span<WindowMotion> motions) {
  std::vector<std::size_t> index;
  windows_.clear();
  seeds_.clear();
  for (const std::size_t i : which) {
    if (!is_lost(motions[i]) || judged_[i] != 0) continue;
    index.push_back(i);
    windows_.push_back(windows[i]);
    seeds_.push_back(motions[i]);
  }
  if (index.empty()) return;
  results_.resize(index.size());
  refine(windows_, seeds_, results_);
  for (std::size_t k = 0; k < index.size(); ++k) {
    if (has_no_texture(results_[k])) motions[index[k]].status = results_[k].status;
  }
}

}  // namespace impactdic
