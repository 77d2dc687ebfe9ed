// What `correlate` measures in the picture, in a camera's plane of motion.
#pragma once

#include <impactdic/correlate.h>

#include <memory>
#include <span>
#include <vector>

namespace impactdic::run {

class PlaneMotion {
 public:
  // `windows`, centred in the reference, and the region about whose centre motions are stated.
  PlaneMotion(const Camera& camera, std::span<const Window> windows,
              const CorrelateRequest& request, const Roi& roi, int spacing_px);
  ~PlaneMotion();

  // Sets the row's motion in the plane, and gives that of every window. `field`: one a window, or
  // empty. Valid until the next call.
  std::span<const PlaneResult> correct(std::span<const WindowMotion> field, MotionRow& row);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace impactdic::run
