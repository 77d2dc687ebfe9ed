// Which of the known names was meant.
#pragma once

#include <string>
#include <vector>

namespace impactdic::cli {

// Those of `known` that lie nearest to `name`, nearest first, three at most: no more than a third
// of the letters wrong, left out, too many or in each other's place (the distance of Damerau, 1964,
// restricted to neighbours), or containing `name` or all of its parts between dashes. Empty where
// none is near.
std::vector<std::string> nearest(const std::string& name, const std::vector<std::string>& known);

// "did you mean --a or --b?"; "" of an empty list. `dashes` stand before every name.
std::string did_you_mean(const std::vector<std::string>& names, const std::string& dashes);

}  // namespace impactdic::cli
