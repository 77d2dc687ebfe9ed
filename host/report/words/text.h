// Formatted text for people.
#pragma once

#include <string>

namespace impactdic::report {

// What printf would print.
[[gnu::format(printf, 1, 2)]] std::string say(const char* format, ...);

}  // namespace impactdic::report
