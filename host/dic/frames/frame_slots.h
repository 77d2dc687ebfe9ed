// Which numbered slots hold a frame, and whether windows name only those.
#pragma once

#include <impactdic/image.h>

#include <span>
#include <vector>

#include "kernels/types.h"

namespace impactdic::dic {

class FrameSlots {
 public:
  explicit FrameSlots(int slots) : filled_(static_cast<std::size_t>(slots < 0 ? 0 : slots)) {}
  int count() const { return static_cast<int>(filled_.size()); }
  // Notes that `frame` goes into `slot`. Throws InvalidArgument for a slot that is not there, an
  // empty frame, or one of another size than the first.
  void fill(int slot, const Frame& frame);
  // Throws InvalidArgument where a window names a slot without a frame.
  void check(std::span<const Window> windows) const;

 private:
  bool holds(int slot) const;
  std::vector<bool> filled_;
  int width_ = 0, height_ = 0;
};

}  // namespace impactdic::dic
