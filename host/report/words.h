// Results in a line for people.
#pragma once

#include <impactdic/advice.h>
#include <impactdic/impact.h>

#include <string>

namespace impactdic::report {

// "85 windows of 15 px, 97 % usable, 0.0123 px expected of each".
std::string in_words(const SizeAdvice& size);
// What the status and the verdict mean.
const char* explain(ImpactStatus status);
const char* explain(ClosureVerdict verdict);
// Status, contact, restitution and friction.
std::string in_words(const ImpactFigures& impact);

}  // namespace impactdic::report
