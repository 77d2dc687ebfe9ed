// The built-in table of analytic and published cases that `impactdic verify` runs.
#pragma once

#include <impactdic/impact_model.h>

#include <functional>
#include <string>
#include <vector>

namespace impactdic::sim::verify {

// One row: a computed figure against what it must be.
struct VerifyCase {
  std::string group;  // e.g. "linear spring-damper"
  std::string name;   // e.g. "restitution against the closed form"
  // Where `expected` comes from; one of kProvenances, then what exactly.
  std::string source;
  double expected = 0;
  double tolerance = 0;  // |computed - expected| <= tolerance, absolute
  std::function<double()> compute;
};

// printed: stands in the dissertation's text. digitised: read off a figure. independent
// calculation: by another program or method. formula: a closed form of the author named.
// regression: our own figure. conservation, limit: what physics demands.
inline constexpr const char* kProvenances[] = {"printed", "digitised",  "independent calculation",
                                               "formula", "regression", "conservation",
                                               "limit"};

inline constexpr double kIntegrated = 1e-9;  // relative accuracy asked of an integration

inline double restitution(const ImpactResult& r) { return r.restitution; }

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
std::vector<VerifyCase> law_cases();          // other normal laws against their formulas
std::vector<VerifyCase> benchmark_cases();    // Chung and Ooi 2011; measured rebounds
std::vector<VerifyCase> accuracy_cases();     // energy, momentum, limits, convergence, events

std::vector<VerifyOutcome> run_cases(const std::vector<VerifyCase>& cases);

}  // namespace impactdic::sim::verify
