// Rows of `verify`: what each deviation is made of, against the whole chain from rows to figures.
#pragma once

#include <vector>

#include "sim/verify/verify_cases.h"

namespace impactdic::run {

// Of every headline figure of an integrated impact: each part of its deviation that follows from
// what a person gives (angle, scale, rate, camera) against finite differences of the chain, and the
// parts' sum.
std::vector<sim::verify::VerifyCase> budget_cases();

}  // namespace impactdic::run
