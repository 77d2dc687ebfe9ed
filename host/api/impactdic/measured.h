// A measured value and how well it is known.
#pragma once

#include <impactdic/units.h>

namespace impactdic {

struct Measured {
  double value = kNotMeasured;
  double sd = kNotMeasured;  // one standard deviation
};

}  // namespace impactdic
