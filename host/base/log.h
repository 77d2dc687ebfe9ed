// What the library has to say to whoever looks for a fault in it.
#pragma once

#include <spdlog/spdlog.h>

namespace impactdic {

// Silent unless the program asks for it with `set_log_verbosity`; spdlog's own default logger is
// left alone.
spdlog::logger& library_log();

// On stderr: below 0 errors, 0 warnings, 1 facts, 2 details. For the command line alone.
void set_log_verbosity(int verbosity);

}  // namespace impactdic
