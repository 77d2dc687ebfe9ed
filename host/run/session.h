// What a session holds; see api/impactdic/device.h.
#pragma once

#include <impactdic/device.h>
#include <tbb/global_control.h>

#include <atomic>
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
  mutable std::mutex mutex;  // of the engines; held while they are opened
  std::vector<std::unique_ptr<opencl::Engine>> engines;
  std::vector<DeviceInfo> opened;   // what was opened last
  bool for_one_run = false;         // nobody asks for the engines behind it
  std::atomic<bool> begun = false;  // to open them
  // Destroyed first: nobody opens or closes any more.
  std::future<void> opening, closing;

  // Opens them where that is still to be done. A run that enqueues work itself does so on an engine
  // beside one of these. Throws InvalidArgument and OpenClError as choose_device does.
  // Where they are opened now, `expects` says what is worth compiling meanwhile (EngineOptions).
  using Expects = std::function<std::vector<opencl::ProgramRequest>(const opencl::Engine&)>;
  std::vector<opencl::Engine*> open_engines(const Expects& expects = nullptr);
  // Begins that beside the caller, for whom drivers take some tenths of a second, unless somebody
  // has; what goes wrong is for `open_engines` to find again.
  void open_beside(Expects expects);
  // Behind the run that the session is for: gives the devices back beside the caller, for whom
  // drivers take a tenth of a second. Else, and where their profile is still asked for, nothing.
  void close_beside();
};

}  // namespace impactdic
