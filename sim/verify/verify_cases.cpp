#include "sim/verify/verify_cases.h"

#include <cmath>
#include <exception>
#include <iterator>

namespace impactdic::sim::verify {

std::vector<VerifyCase> impact_cases() {
  std::vector<VerifyCase> cases;
  for (auto part : {source_cases, closed_form_cases, law_cases, benchmark_cases, accuracy_cases}) {
    std::vector<VerifyCase> rows = part();
    std::move(rows.begin(), rows.end(), std::back_inserter(cases));
  }
  return cases;
}

std::vector<VerifyOutcome> run_cases(const std::vector<VerifyCase>& cases) {
  std::vector<VerifyOutcome> outcomes;
  outcomes.reserve(cases.size());
  for (const VerifyCase& row : cases) {
    VerifyOutcome outcome;
    outcome.row = row;
    try {
      outcome.computed = row.compute();
      outcome.passed = std::abs(outcome.computed - row.expected) <= row.tolerance;
    } catch (const std::exception& error) {
      outcome.computed = std::nan("");
      outcome.error = error.what();
    }
    outcomes.push_back(std::move(outcome));
  }
  return outcomes;
}

}  // namespace impactdic::sim::verify
