// Results in a line for people.
#pragma once

#include <impactdic/advice.h>
#include <impactdic/correlate.h>
#include <impactdic/impact.h>

#include <string>

namespace impactdic::report {

// "85 windows of 15 px, 97 % usable, 0.0123 px expected of each".
std::string in_words(const SizeAdvice& size);
// "0.1234 +- 0.0002 mm/px in the plane of motion, …".
std::string in_words(const PlaneFigures& camera);
// "0.0051, 0.0049 px over the windows and 0.0036, 0.0035 px over the frames 0 to 9 (stated …)".
std::string in_words(const NoiseFloor& floor);
// What the status and the verdict mean.
const char* explain(ImpactStatus status);
const char* explain(ClosureVerdict verdict);
// Status, contact, restitution and friction.
std::string in_words(const ImpactFigures& impact);

}  // namespace impactdic::report
