// The rod's rows of the built-in table of `impactdic verify`.
#pragma once

#include <vector>

#include "sim/verify/verify_cases.h"

namespace impactdic::sim::verify {

// Elastic-plastic contact, rigid and flexible rod, impulse closure.
std::vector<VerifyCase> rod_cases();

}  // namespace impactdic::sim::verify
