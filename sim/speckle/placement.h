// Places speckles on a disc one after the other, keeping a gap between them while there is room.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "sim/speckle/pattern.h"

namespace impactdic::sim::speckle {

// The same numbers on every platform: the C++ standard fixes the engine, but neither the
// distributions nor the rounding of std::generate_canonical, so these are ours.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream);
  double uniform();  // [0, 1)
  double normal();   // Box & Muller (1958)

 private:
  std::mt19937_64 engine_;
};

// How speckles are spaced, on a disc and on a sphere.
inline constexpr double kFirstGap = 3;   // px
inline constexpr double kGapStep = 0.1;  // px, taken off after so many vain tries
inline constexpr int kTriesPerGap = 60;
inline constexpr int kSweeps = 60;  // that push speckles apart
inline constexpr double kCell = 6;  // side of a cell in which near speckles are looked up, px

// Each shape goes where it keeps the current gap to all placed before; after many vain tries the
// gap shrinks (below 0: overlap), for good. Fed with the largest first, it packs densely.
class Placement {
 public:
  explicit Placement(double ball_radius_px);
  // `shape`: discs about an origin, px. It is moved to a free place on the ball, rim included.
  void place(std::vector<InkDisc> shape, Random& random);
  // Pushes discs that are closer than `gap_px` apart from each other, so that what is crowded still
  // shows as separate speckles. For shapes of one disc.
  void spread(double gap_px);
  const std::vector<InkDisc>& discs() const { return discs_; }

 private:
  // Calls visit(disc index) for every placed disc whose cell is within `near_px`; stops when it
  // returns false, and returns that.
  template <typename Visit>
  bool each_near(double x_px, double y_px, double near_px, const Visit& visit) const;
  bool fits(const std::vector<InkDisc>& shape, double x_px, double y_px) const;
  std::size_t cell(double x_px, double y_px) const;
  bool push_apart(std::size_t index, double gap_px);

  double radius_px_, gap_px_, largest_px_ = 0;
  int cells_;  // a side
  std::vector<std::vector<int>> grid_;
  std::vector<InkDisc> discs_;
};

}  // namespace impactdic::sim::speckle
