// What a session holds; see api/impactdic/device.h.
#pragma once

#include <impactdic/device.h>
#include <tbb/global_control.h>

#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "host/opencl/engine.h"

namespace impactdic {

struct Session::Impl {
  SessionOptions options;
  std::optional<tbb::global_control> thread_limit;
  mutable std::mutex mutex;  // of what follows
  std::vector<std::unique_ptr<opencl::Engine>> engines;
  std::future<void> opening;  // destroyed first: waits until nobody opens any more

  // Opens them where that is still to be done. A run that enqueues work itself does so on an engine
  // beside one of these. Throws InvalidArgument and OpenClError as choose_device does.
  // Where they are opened now, `expects` says what is worth compiling meanwhile (EngineOptions).
  using Expects = std::function<std::vector<opencl::ProgramRequest>(const opencl::Engine&)>;
  std::vector<opencl::Engine*> open_engines(const Expects& expects = nullptr);
  // Begins that beside the caller, for whom drivers take some tenths of a second; what goes wrong
  // is for `open_engines` to find again.
  void open_beside(Expects expects);
};

}  // namespace impactdic
