// The library's log: silent until the command line sets a level. Goes to stderr.
#pragma once

#include <spdlog/spdlog.h>

namespace impactdic {

// -1: errors only; 0: warnings; 1: information; 2: debugging.
void set_log_verbosity(int verbosity);

}  // namespace impactdic
