#include "host/base/log.h"

#include <spdlog/sinks/stdout_sinks.h>

#include <memory>

namespace impactdic {

spdlog::logger& library_log() {
  static spdlog::logger logger("impactdic");  // without a place to write to
  return logger;
}

void set_log_verbosity(int verbosity) {
  if (library_log().sinks().empty()) {
    library_log().sinks().push_back(std::make_shared<spdlog::sinks::stderr_sink_mt>());
    library_log().set_pattern("impactdic: %l: %v");
  }
  library_log().set_level(verbosity < 0    ? spdlog::level::err
                          : verbosity == 0 ? spdlog::level::warn
                          : verbosity == 1 ? spdlog::level::info
                                           : spdlog::level::debug);
}

}  // namespace impactdic
