// The built-in table of analytic and published cases that `impactdic verify` runs.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace impactdic::sim::verify {

// One row: a computed figure against what it must be.
struct VerifyCase {
  std::string group;   // e.g. "linear spring-damper"
  std::string name;    // e.g. "restitution against the closed form"
  std::string source;  // e.g. "Hertz 1882", "section 3.1.3", "energy"
  double expected = 0;
  double tolerance = 0;  // |computed - expected| <= tolerance, absolute
  std::function<double()> compute;
};

struct VerifyOutcome {
  VerifyCase row;
  double computed = 0;
  bool passed = false;
  std::string error;  // what was thrown, if anything was
};

// The plane ball impacts: the dissertation's figures, closed forms, limits, conservation, accuracy.
std::vector<VerifyCase> impact_cases();
std::vector<VerifyCase> source_cases();       // chapters 3 and 4
std::vector<VerifyCase> closed_form_cases();  // formulas, and integrations against them
std::vector<VerifyCase> accuracy_cases();     // energy, momentum, limits, convergence, events

std::vector<VerifyOutcome> run_cases(const std::vector<VerifyCase>& cases);

}  // namespace impactdic::sim::verify
