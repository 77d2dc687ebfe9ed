#include "host/app/run_context.h"

#include <tbb/global_control.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "host/base/log.h"

namespace impactdic::app {

struct RunContext::Threads {
  tbb::global_control control;
  explicit Threads(int count)
      : control(tbb::global_control::max_allowed_parallelism,
                count > 0 ? static_cast<std::size_t>(count)
                          : std::max(1u, std::thread::hardware_concurrency())) {}
};

RunContext::RunContext(const Common& common, bool with_device)
    : threads_(std::make_unique<Threads>(common.threads)) {
  set_log_verbosity(common.quiet ? -1 : common.verbosity);
  if (!with_device) return;
  EngineOptions options;
  options.profile = common.verbosity > 0;
  engine_ = std::make_unique<Engine>(common.device, options);
}

RunContext::~RunContext() = default;

Attributes RunContext::attributes(const VideoInfo& info, const std::string& sha256) const {
  Attributes attributes = {
      {"program", std::string("impactdic")},
      {"version", std::string(IMPACTDIC_VERSION)},
      {"source", info.path},
      {"source_sha256", sha256},
      {"axes", std::string("image axes: x right, y down, pixel centres at integers, (0, 0) the "
                           "centre of the top-left pixel; u along x, v along y; rotation positive "
                           "counter-clockwise as seen on the screen")}};
  if (engine_) {
    attributes["device"] = engine_->device().name;
    attributes["driver"] = engine_->device().driver;
    attributes["platform"] = engine_->device().platform;
  }
  return attributes;
}

nlohmann::json RunContext::describe() const {
  if (!engine_) return nullptr;
  const DeviceInfo& device = engine_->device();
  return {{"name", device.name}, {"platform", device.platform}, {"driver", device.driver}};
}

void RunContext::print_profile() {
  if (!engine_ || !engine_->profiler().enabled()) return;
  std::fputs(engine_->profiler().table().c_str(), stderr);
}

}  // namespace impactdic::app
