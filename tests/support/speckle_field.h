// The exact speckled surface under the tests' namespace.
#pragma once

#include "sim/speckle/speckle_field.h"

namespace impactdic::testing {
using impactdic::SpeckleField;
}  // namespace impactdic::testing
