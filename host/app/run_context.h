// What one run of a measuring command has about it: device, clock, and how it describes itself.
#pragma once

#include <chrono>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/app/command.h"
#include "host/opencl/engine.h"
#include "host/report/fields_file.h"
#include "host/video/frame_source.h"

namespace impactdic::app {

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

class RunContext {
 public:
  // Sets the log's level and the number of threads; opens the device unless `with_device` is
  // false. Throws as Engine does.
  explicit RunContext(const Common& common, bool with_device = true);
  ~RunContext();

  Engine& engine() { return *engine_; }
  Engine* engine_or_null() { return engine_.get(); }
  // Version, device, driver, source and axes, for fields.h5.
  Attributes attributes(const VideoInfo& info, const std::string& sha256) const;
  // The device for summary.json; null without one.
  nlohmann::json describe() const;
  // With -v: the profiler's table on stderr.
  void print_profile();

 private:
  struct Threads;
  std::unique_ptr<Threads> threads_;
  std::unique_ptr<Engine> engine_;
};

}  // namespace impactdic::app
