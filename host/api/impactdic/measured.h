// A measured value and how well it is known.
#pragma once

#include <impactdic/export.h>
#include <impactdic/units.h>

namespace IMPACTDIC_PUBLIC impactdic {

struct Measured {
  double value = kNotMeasured;
  double sd = kNotMeasured;  // one standard deviation
};

}  // namespace impactdic
