// IC-GN refinement of interrogation windows in double precision on the host: what
// kernels/icgn/icgn.cl is tested against. Slow.
#pragma once

#include <limits>
#include <vector>

#include "host/dic/field.h"
#include "host/dic/frames/bspline.h"

namespace impactdic::dic {

class IcgnReference {
 public:
  // Takes window_px, spline_degree, max_iterations, min_correlation and min_texture of `options`.
  IcgnReference(const FieldOptions& options, int slots);

  void set_frame(int slot, const Frame& frame);
  // As IcgnRefiner::set_disc.
  void set_disc(int slot, double cx_px, double cy_px, double radius_px);

  // Refines one window from the seed (u, v; the rotation is the window's guess_rot_rad). A seed
  // that is not ok comes back as it is. Throws InvalidArgument for a slot without a frame.
  WindowMotion refine(const Window& window, const WindowMotion& seed) const;

 private:
  struct Slot {
    BSplineImage spline;
    double full_scale = 255;
    double cx_px = 0, cy_px = 0, radius_px = std::numeric_limits<double>::infinity();
  };
  const Slot& slot(int index) const;
  FieldOptions options_;
  std::vector<Slot> slots_;
};

}  // namespace impactdic::dic
