// What one run of a measuring command has about it: device, clock, and how it describes itself.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "host/app/command.h"
#include "host/base/stage_times.h"
#include "host/base/stopwatch.h"
#include "host/opencl/engine.h"
#include "host/report/fields_file.h"
#include "host/video/frame_source.h"

namespace impactdic::app {

class RunContext {
 public:
  // Sets the log's level and the number of threads; opens the device unless `with_device` is
  // false. Throws as Engine does.
  explicit RunContext(const Common& common, bool with_device = true);
  ~RunContext();

  // The device, the first of several.
  opencl::Engine& engine() { return *engines_.front(); }
  // All of them; none where the run needs no device.
  std::vector<opencl::Engine*> engines();
  // Version, device, driver, source (its digest comes later) and axes, for fields.h5.
  report::Attributes attributes(const ClipInfo& info) const;
  // The device for summary.json; null without one.
  nlohmann::json describe() const;
  // Where the stages of a pipeline note their times; nullptr without -v.
  StageTimes* stage_times() { return verbose_ ? &stage_times_ : nullptr; }
  // With -v: what the stages of a pipeline over `frames` frames took of `wall_s`.
  void print_stages(double wall_s, std::int64_t frames);
  // With -v: the profiler's table on stderr.
  void print_profile();

 private:
  struct Threads;
  std::unique_ptr<Threads> threads_;
  std::vector<std::unique_ptr<opencl::Engine>> engines_;
  bool verbose_ = false;
  StageTimes stage_times_;
};

}  // namespace impactdic::app
