#include "host/dic/neighbours.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

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

bool is_lost(const WindowMotion& motion) {
  const auto status = static_cast<WindowStatus>(motion.status);
  return status == WindowStatus::low_correlation || status == WindowStatus::at_search_edge ||
         status == WindowStatus::not_converged;
}

// The windows of one pair of frames by place: square bins, as wide as a window.
class Bins {
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
    index_.resize(windows.size());
    for (std::size_t i = 0; i < windows.size(); ++i) index_[next[bin(windows[i])]++] = i;
  }

  // Calls visit(index) for all windows in the 3 × 3 bins about this one's.
  template <typename Visit>
  void each_near(const Window& window, const Visit& visit) const {
    const int column = (window.x0 - x0_) / side_, row = (window.y0 - y0_) / side_;
    for (int j = std::max(0, row - 1); j <= std::min(down_ - 1, row + 1); ++j) {
      for (int i = std::max(0, column - 1); i <= std::min(across_ - 1, column + 1); ++i) {
        const auto at = static_cast<std::size_t>(j * across_ + i);
        for (std::size_t k = begin_[at]; k < begin_[at + 1]; ++k) visit(index_[k]);
      }
    }
  }

 private:
  std::size_t bin(const Window& window) const {
    return static_cast<std::size_t>((window.y0 - y0_) / side_ * across_ +
                                    (window.x0 - x0_) / side_);
  }
  int side_, x0_, y0_, across_, down_;
  std::vector<std::size_t> begin_, index_;
};

float median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// What window `from` says of the displacement at window `at`.
struct Shift {
  float u, v;
};
Shift carried(const Window& from, const WindowMotion& motion, const Window& at) {
  const auto dx = static_cast<float>(at.x0 - from.x0), dy = static_cast<float>(at.y0 - from.y0);
  return {motion.u + motion.ux * dx + motion.uy * dy, motion.v + motion.vx * dx + motion.vy * dy};
}

// One pair's windows, and which of them have new neighbours since they were last tried.
class Front {
 public:
  Front(std::span<const Window> windows, int window_px, std::span<WindowMotion> motions)
      : windows_(windows),
        motions_(motions),
        bins_(windows, window_px),
        tried_(windows.size(), 0),
        challenged_(windows.size(), false) {}

  // A window and its seed for every lost one that has found neighbours not seen before, and for
  // every suspect, once.
  void propose() {
    proposed_.clear();
    proposed_windows.clear();
    seeds.clear();
    for (std::size_t i = 0; i < windows_.size(); ++i) {
      if (is_found(motions_[i])) {
        if (challenged_[i] || !is_suspect(i)) continue;
        challenged_[i] = true;
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
      if (!is_found(results[k])) continue;
      if (is_found(motion) && !(results[k].correlation > motion.correlation)) continue;
      motion = results[k];
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

  // The nearest found windows into `near_`; returns how many there are at all.
  std::size_t gather(std::size_t i) {
    near_.clear();
    bins_.each_near(windows_[i], [&](std::size_t k) {
      if (!is_found(motions_[k])) return;
      const int dx = windows_[k].x0 - windows_[i].x0, dy = windows_[k].y0 - windows_[i].y0;
      near_.push_back({dx * dx + dy * dy, k});
    });
    const std::size_t found = near_.size();
    const std::size_t count = std::min(kNearest, found);
    std::partial_sort(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(count),
                      near_.end());
    near_.resize(count);
    return found;
  }

  // Where the windows in `near_` say that window i went, each component's median; and the median
  // distance of what they say from that.
  Shift consensus(std::size_t i, float* scatter) {
    u_.clear();
    v_.clear();
    for (const Neighbour& neighbour : near_) {
      const Shift shift =
          carried(windows_[neighbour.index], motions_[neighbour.index], windows_[i]);
      u_.push_back(shift.u);
      v_.push_back(shift.v);
    }
    const Shift middle = {median(u_), median(v_)};
    for (std::size_t k = 0; k < near_.size(); ++k) {
      const Shift shift = carried(windows_[near_[k].index], motions_[near_[k].index], windows_[i]);
      u_[k] = std::max(std::abs(shift.u - middle.u), std::abs(shift.v - middle.v));
    }
    *scatter = median(u_);
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
    std::erase_if(near_, [&](const Neighbour& neighbour) { return neighbour.index == i; });
    if (near_.size() < kFewestWitnesses) return false;
    float scatter = 0;
    const Shift shift = consensus(i, &scatter);
    return differs(shift, kSuspectPx + 3 * scatter);
  }

  void seed(std::size_t i) {
    float scatter = 0;
    const Shift shift = consensus(i, &scatter);
    u_.clear();
    for (const Neighbour& neighbour : near_) {
      const WindowMotion& m = motions_[neighbour.index];
      u_.push_back(std::atan2(m.uy - m.vx, 2 + m.ux + m.vy));
    }
    Window window = windows_[i];
    window.guess_rot_rad = median(u_);
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
  Bins bins_;
  std::vector<std::size_t> tried_, proposed_;
  std::vector<bool> challenged_;
  std::vector<Neighbour> near_;
  std::vector<float> u_, v_;
};

}  // namespace

void refine_from_neighbours(std::span<const Window> windows, int window_px,
                            const RefineWindows& refine, std::span<WindowMotion> motions) {
  std::vector<Front> fronts;
  for (std::size_t begin = 0, end; begin < windows.size(); begin = end) {
    for (end = begin; end < windows.size() && windows[end].first == windows[begin].first &&
                      windows[end].second == windows[begin].second;) {
      ++end;
    }
    fronts.emplace_back(windows.subspan(begin, end - begin), window_px,
                        motions.subspan(begin, end - begin));
  }
  bool any = true;
  for (int round = 0; round < kMostRounds && any; ++round) {
    tbb::parallel_for(std::size_t{0}, fronts.size(), [&](std::size_t k) { fronts[k].propose(); });
    std::vector<Window> again;
    std::vector<WindowMotion> seeds;
    for (const Front& front : fronts) {
      again.insert(again.end(), front.proposed_windows.begin(), front.proposed_windows.end());
      seeds.insert(seeds.end(), front.seeds.begin(), front.seeds.end());
    }
    if (again.empty()) return;
    const std::vector<WindowMotion> results = refine(again, seeds);
    any = false;
    std::size_t at = 0;
    for (Front& front : fronts) {
      const std::size_t count = front.seeds.size();
      any = front.accept(std::span(results).subspan(at, count)) || any;
      at += count;
    }
  }
}

void judge_lost(std::span<const Window> windows, const RefineWindows& refine,
                std::span<WindowMotion> motions) {
  std::vector<std::size_t> index;
  std::vector<Window> lost;
  std::vector<WindowMotion> seeds;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (!is_lost(motions[i])) continue;
    index.push_back(i);
    lost.push_back(windows[i]);
    seeds.push_back(motions[i]);
  }
  if (lost.empty()) return;
  const std::vector<WindowMotion> judged = refine(lost, seeds);
  for (std::size_t k = 0; k < index.size(); ++k) {
    if (has_no_texture(judged[k])) motions[index[k]].status = judged[k].status;
  }
}

}  // namespace impactdic
