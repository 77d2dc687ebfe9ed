// How the windows of a grid stand to each other: who is near, by bins and by lists.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host/dic/field.h"

namespace impactdic::dic {

// Near are the windows in the 3 × 3 square bins, each as wide as a window, about a window's own.
// For use by one thread.
class WindowPlaces {
 public:
  using Index = std::uint32_t;  // of a window in the grid

  WindowPlaces(std::span<const Window> windows, int side);

  std::size_t size() const { return x_.size(); }
  // Whether `windows` begin with a pair of frames whose windows stand like these, and no more.
  bool lead(std::span<const Window> windows, int side) const;
  // From window `from` to window `to`, px.
  int dx(Index from, Index to) const { return x_[to] - x_[from]; }
  int dy(Index from, Index to) const { return y_[to] - y_[from]; }

  // A value for every bin, and some that are never asked for.
  std::size_t bins() const { return begin_.size() - 1; }
  std::uint32_t bin(Index i) const { return bin_[i]; }
  // Sets the values of the bins whose windows are near window i.
  void mark_near(Index i, std::uint8_t value, std::span<std::uint8_t> bins) const {
    const auto mark = [value](std::uint8_t* row) { row[0] = row[1] = row[2] = value; };
    std::uint8_t* const middle = bins.data() + bin_[i] - 1;
    mark(middle - across_);
    mark(middle);
    mark(middle + across_);
  }

  static constexpr std::size_t kNearest = 6;
  struct Nearest {
    std::array<Index, kNearest + 8> index;  // the last are for writing beyond the end
    std::size_t count;
  };
  // Those near window i, itself among them, whose `state` is odd: the kNearest nearest, or as many
  // as there are, nearest first.
  void find_nearest(Index i, std::span<const std::uint8_t> state, Nearest& found);

 private:
  // Beginning of a window's neighbours by distance; a list that is not full holds them all.
  static constexpr std::size_t kListed = 40;
  static_assert(kListed % 8 == 0);
  struct List {
    std::array<Index, kListed> index;
    std::uint32_t count = 0;  // 0: not made yet
  };
  const List& list(Index i);
  void find_among_all(Index i, std::span<const std::uint8_t> state, Nearest& found) const;
  template <typename Visit>
  void each_near(Index i, const Visit& visit) const;

  int side_;
  std::size_t across_;      // bins in a row, of which the first and the last are empty
  std::vector<int> x_, y_;  // from the first window
  std::vector<std::uint32_t> bin_, begin_;
  std::vector<Index> entries_;  // by bin, from begin_[bin] to begin_[bin + 1]
  std::vector<List> lists_;
};

}  // namespace impactdic::dic
