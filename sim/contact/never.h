// When what does not happen happens.
#pragma once

#include <limits>

namespace impactdic::sim::contact {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

}  // namespace impactdic::sim::contact
