#include "host/base/log.h"

#include <spdlog/sinks/stdout_sinks.h>

#include <memory>

namespace impactdic {

void set_log_verbosity(int verbosity) {
  static const auto logger = [] {
    auto made = std::make_shared<spdlog::logger>("impactdic",
                                                 std::make_shared<spdlog::sinks::stderr_sink_mt>());
    made->set_pattern("impactdic: %l: %v");
    spdlog::set_default_logger(made);
    return made;
  }();
  logger->set_level(verbosity < 0    ? spdlog::level::err
                    : verbosity == 0 ? spdlog::level::warn
                    : verbosity == 1 ? spdlog::level::info
                                     : spdlog::level::debug);
}

}  // namespace impactdic
