// Results of models in lines for people.
#pragma once

#include <impactdic/compare.h>
#include <impactdic/fit.h>
#include <impactdic/rod.h>
#include <impactdic/simulate.h>

#include <string>

namespace impactdic::report {

// Restitution, duration, motion after the impact and the contact's phases, of `simulate`.
std::string in_words(const ImpactJob& job, const ImpactResult& result);
// Restitution and motion after, of a formula.
std::string in_words(const ReboundResult& result);
// Restitution, micro-impacts, dent and motion after, of a rod's model.
std::string in_words(const RodImpact& impact);
// Measured motion before and after, predictions beside it, and the impulses' closure.
std::string in_words(const RodResult& result);
// Every parameter of one shot with its deviation, or the mean of several shots.
std::string in_words(const FitResult& result);
// Measured and predicted motion after the impact, a line a model.
std::string in_words(const CompareResult& result);
std::string in_words(const RodCompareResult& result);

}  // namespace impactdic::report
