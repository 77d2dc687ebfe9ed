// Places speckles on a sphere one after the other, keeping a gap between them while there is room.
#pragma once

#include <vector>

#include "sim/speckle/placement.h"
#include "sim/speckle/sphere/sphere.h"

namespace impactdic::sim::speckle {

// Unit vectors of a plane that touches the sphere at a unit vector.
struct TangentPlane {
  Eigen::Vector3d u, v;
  explicit TangentPlane(const Eigen::Vector3d& at);
};

// As Placement on a disc: each shape goes where it keeps the current gap to all placed before;
// after many vain tries the gap shrinks, for good. Distances are chords.
class SpherePlacement {
 public:
  explicit SpherePlacement(double ball_radius_px);
  // `shape`: discs about an origin, px. It is turned at random and laid on a free place.
  void place(const std::vector<InkDisc>& shape, Random& random);
  // Pushes caps that are closer than `gap_px` apart from each other. For shapes of one disc.
  void spread(double gap_px);
  const std::vector<InkCap>& caps() const { return caps_; }

 private:
  // Calls visit(cap index) for every placed cap whose cell is within `near_px`; stops when it
  // returns false, and returns that.
  template <typename Visit>
  bool each_near(const Eigen::Vector3d& at, double near_px, const Visit& visit) const;
  bool fits(const std::vector<InkCap>& shape) const;
  int band_of(double z) const;
  std::size_t cell(const Eigen::Vector3d& at) const;
  bool push_apart(std::size_t index, double gap_px);

  double radius_px_, gap_px_, largest_px_ = 0;
  int bands_;                       // of latitude, equally wide
  std::vector<int> cells_;          // of longitude in each band
  std::vector<std::size_t> first_;  // index of a band's first cell
  std::vector<std::vector<int>> grid_;
  std::vector<InkCap> caps_;
};

// Evenly distributed on the sphere.
Eigen::Vector3d random_direction(Random& random);

}  // namespace impactdic::sim::speckle
