// The rod's rows of the built-in table of `impactdic verify`.
#pragma once

#include <vector>

#include "sim/impact/verify_cases.h"

namespace impactdic {

// Elastic-plastic contact, rigid and flexible rod, impulse closure.
std::vector<VerifyCase> rod_cases();

}  // namespace impactdic
