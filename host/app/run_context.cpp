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
  verbose_ = common.verbosity > 0 && !common.quiet;
  if (!with_device) return;
  opencl::EngineOptions options;
  options.profile = common.verbosity > 0;
  if (common.device != "all") {
    engines_.push_back(std::make_unique<opencl::Engine>(common.device, options));
    return;
  }
  for (const opencl::Device& device : opencl::all_devices(opencl::list_devices())) {
    engines_.push_back(std::make_unique<opencl::Engine>(std::to_string(device.index), options));
  }
}

RunContext::~RunContext() = default;

std::vector<opencl::Engine*> RunContext::engines() {
  std::vector<opencl::Engine*> engines;
  for (const auto& engine : engines_) engines.push_back(engine.get());
  return engines;
}

report::Attributes RunContext::attributes(const ClipInfo& info) const {
  report::Attributes attributes = {
      {"program", std::string("impactdic")},
      {"version", std::string(IMPACTDIC_VERSION)},
      {"source", info.path},
      {"source_sha256", std::string()},
      {"axes", std::string("image axes: x right, y down, pixel centres at integers, (0, 0) the "
                           "centre of the top-left pixel; u along x, v along y; rotation positive "
                           "counter-clockwise as seen on the screen")}};
  if (!engines_.empty()) {
    const opencl::Device& device = engines_.front()->device();
    attributes["device"] = device.name;
    attributes["driver"] = device.driver;
    attributes["platform"] = device.platform;
    attributes["devices"] = static_cast<double>(engines_.size());
  }
  return attributes;
}

nlohmann::json RunContext::describe() const {
  if (engines_.empty()) return nullptr;
  const opencl::Device& device = engines_.front()->device();
  return {{"name", device.name},
          {"platform", device.platform},
          {"driver", device.driver},
          {"count", engines_.size()}};
}

void RunContext::print_stages(double wall_s, std::int64_t frames) {
  if (!verbose_ || stage_times_.rows().empty()) return;
  std::fputs(stage_times_.table(wall_s, frames).c_str(), stderr);
}

void RunContext::print_profile() {
  for (const auto& engine : engines_) {
    if (!engine->profiler().enabled()) continue;
    if (engines_.size() > 1) std::fprintf(stderr, "%s\n", engine->device().name.c_str());
    std::fputs(engine->profiler().table().c_str(), stderr);
  }
}

}  // namespace impactdic::app
