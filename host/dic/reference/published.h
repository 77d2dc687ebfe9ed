// The dissertation's method (section 2.2), read plainly, in double precision.
#pragma once

#include <impactdic/image.h>

#include <vector>

#include "host/dic/field.h"

namespace impactdic::dic {

// One window by the published method: the window and the one at the same place (plus the guess) in
// the second frame, both mean-free, `interp_points` values of the bicubic spline between pixels,
// cross-correlated by FFT with zero padding; the lag of the largest value. Its quantum is
// 1/(interp_points + 1) px, whose standard deviation (quantum/√12) is u_sd, v_sd. It is biased
// toward zero, the overlap shrinking with the lag. correlation: the largest value over the energies
// of the whole windows. Statuses: out_of_view, no_texture (either window); every maximum is taken.
// One copy of the interpolation matrix serves all windows.
class PublishedReference {
 public:
  explicit PublishedReference(const FieldOptions& options);
  WindowMotion measure(ImageView<const float> first, ImageView<const float> second,
                       const Window& window, double full_scale) const;

 private:
  FieldOptions options_;
  std::vector<double> matrix_;  // cubic_interpolation_matrix
};

}  // namespace impactdic::dic
