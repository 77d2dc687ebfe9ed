// What the ZNCC runs with when it only seeds a refinement.
#pragma once

#include <algorithm>

#include "host/dic/field.h"

namespace impactdic::dic {

// The options of the seed: those of the method, but with a lower bar for the correlation, which a
// rotation or a strain within the window pulls down and the refinement then restores. The
// refinement applies the bar that was asked for.
inline FieldOptions seed_options(FieldOptions options) {
  constexpr double kSeedCorrelation = 0.3;
  if (options.method == FieldMethod::kIcgn) {
    options.min_correlation = std::min(options.min_correlation, kSeedCorrelation);
  }
  return options;
}

}  // namespace impactdic::dic
