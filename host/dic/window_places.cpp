#include "host/dic/window_places.h"

#include <algorithm>

namespace impactdic::dic {
namespace {

using Index = WindowPlaces::Index;

struct Neighbour {
  int distance2;
  Index index;
  bool operator<(const Neighbour& other) const {
    return distance2 != other.distance2 ? distance2 < other.distance2 : index < other.index;
  }
};

}  // namespace

WindowPlaces::WindowPlaces(std::span<const Window> windows, int side)
    : side_(side), lists_(windows.size()) {
  int left = windows[0].x0, right = left, top = windows[0].y0, bottom = top;
  for (const Window& window : windows) {
    x_.push_back(window.x0 - windows[0].x0);
    y_.push_back(window.y0 - windows[0].y0);
    left = std::min(left, window.x0);
    right = std::max(right, window.x0);
    top = std::min(top, window.y0);
    bottom = std::max(bottom, window.y0);
  }
  // Empty ones all around: whoever looks at a bin's neighbours asks for no bounds.
  across_ = static_cast<std::size_t>((right - left) / side + 3);
  const auto down = static_cast<std::size_t>((bottom - top) / side + 3);
  begin_.assign(across_ * down + 1, 0);
  for (const Window& window : windows) {
    const auto column = static_cast<std::size_t>((window.x0 - left) / side + 1);
    const auto row = static_cast<std::size_t>((window.y0 - top) / side + 1);
    bin_.push_back(static_cast<std::uint32_t>(row * across_ + column));
    ++begin_[bin_.back() + 1];
  }
  for (std::size_t k = 1; k < begin_.size(); ++k) begin_[k] += begin_[k - 1];
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  entries_.resize(windows.size());
  for (Index i = 0; i < windows.size(); ++i) entries_[next[bin_[i]]++] = i;
}

bool WindowPlaces::lead(std::span<const Window> windows, int side) const {
  const std::size_t count = size();
  if (side != side_ || windows.size() < count) return false;
  const Window& begin = windows[0];
  const auto is_of_pair = [&](const Window& window) {
    return window.first == begin.first && window.second == begin.second;
  };
  if (windows.size() > count && is_of_pair(windows[count])) return false;
  int differs = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Window& window = windows[i];
    differs |= (window.x0 - begin.x0) ^ x_[i];
    differs |= (window.y0 - begin.y0) ^ y_[i];
    differs |= (window.first ^ begin.first) | (window.second ^ begin.second);
  }
  return differs == 0;
}

template <typename Visit>
void WindowPlaces::each_near(Index i, const Visit& visit) const {
  const std::size_t above = bin_[i] - across_ - 1;
  for (std::size_t row = above; row <= above + 2 * across_; row += across_) {
    for (std::uint32_t k = begin_[row]; k < begin_[row + 3]; ++k) {
      const int x = dx(i, entries_[k]), y = dy(i, entries_[k]);
      visit(Neighbour{x * x + y * y, entries_[k]});
    }
  }
}

const WindowPlaces::List& WindowPlaces::list(Index i) {
  List& list = lists_[i];
  if (list.count > 0) return list;
  std::vector<Neighbour> all;
  each_near(i, [&](const Neighbour& neighbour) { all.push_back(neighbour); });
  list.count = static_cast<std::uint32_t>(std::min(all.size(), kListed));
  const auto end = all.begin() + list.count;
  std::partial_sort(all.begin(), end, all.end());
  // The rest names the window itself: to be looked at in eights.
  list.index.fill(i);
  std::transform(all.begin(), end, list.index.begin(), [](const Neighbour& n) { return n.index; });
  return list;
}

void WindowPlaces::find_nearest(Index i, std::span<const std::uint8_t> state, Nearest& found) {
  const List& near = list(i);
  std::size_t count = 0;
  // By eights, since which of them are found is chance.
  for (std::uint32_t begin = 0; begin < near.count && count < kNearest; begin += 8) {
    for (std::uint32_t k = begin; k < begin + 8; ++k) {
      found.index[count] = near.index[k];
      count += (state[near.index[k]] & 1U) & (k < near.count ? 1U : 0U);
    }
  }
  found.count = std::min(count, kNearest);
  if (count < kNearest && near.count == kListed) find_among_all(i, state, found);
}

void WindowPlaces::find_among_all(Index i, std::span<const std::uint8_t> state,
                                  Nearest& found) const {
  std::array<Neighbour, kNearest> near;
  std::size_t count = 0;
  each_near(i, [&](const Neighbour& neighbour) {
    if ((state[neighbour.index] & 1U) == 0) return;
    if (count == kNearest && !(neighbour < near[kNearest - 1])) return;
    std::size_t at = count < kNearest ? count++ : kNearest - 1;
    for (; at > 0 && neighbour < near[at - 1]; --at) near[at] = near[at - 1];
    near[at] = neighbour;
  });
  found.count = count;
  std::transform(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count),
                 found.index.begin(), [](const Neighbour& n) { return n.index; });
}

}  // namespace impactdic::dic
