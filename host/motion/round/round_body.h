// What views of a body that is no sphere tell of it before its turns are measured.
#pragma once

#include <impactdic/image.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "host/motion/round/round_view.h"

namespace impactdic::motion {

class RoundBody {
 public:
  using ReadFrame = std::function<Frame(std::int64_t index)>;

  // Looks at frames spread over 0 … count − 1. nullopt where most of them show no silhouette.
  static std::optional<RoundBody> learn(const ReadFrame& read, std::int64_t count);

  const RoundFrame& round() const { return round_; }
  // The longest semi-axis of any outline over the shortest one.
  double stretch() const { return longest_px_ / shortest_px_; }
  // By how much the outline's shape changes over the views, share of its radius: the scatter of
  // radius and ellipse.
  double change() const { return change_; }
  // What the depth of a point of the surface may be wrong by, share of itself: half of what the
  // semi-axes differ by.
  double depth_sd() const { return (longest_px_ - shortest_px_) / 2 / round_.radius_px; }
  // What stays in its place while the body turns, which is light: the mean of the views but for
  // those of two frames, whose own texture it would hold. Empty where too few are left.
  RoundView light_beside(std::int64_t first, std::int64_t second) const;

 private:
  RoundFrame round_;
  double longest_px_ = 0, shortest_px_ = 0, change_ = 0;
  std::vector<std::pair<std::int64_t, RoundView>> views_;
};

}  // namespace impactdic::motion
