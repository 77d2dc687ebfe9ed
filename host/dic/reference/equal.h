// Equal windows by circular cross-correlation by its definition, in double precision.
#pragma once

#include <impactdic/image.h>

#include "host/dic/field.h"

namespace impactdic::dic {

// Displacement of `window` from picture `first` to picture `second`: circular cross-correlation of
// the mean-free windows by direct sums; its highest value (of equal ones the leftmost, of those the
// topmost); the value there and its four neighbours over the share of the windows that overlaps at
// their lag; the Gaussian through them (Westerweel 1997). What kernels/equal/equal.cl is tested
// against.
WindowMotion equal_reference(ImageView<const float> first, ImageView<const float> second,
                             const Window& window, const FieldOptions& options, double full_scale);

}  // namespace impactdic::dic
