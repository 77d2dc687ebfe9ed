#include "host/run/session.h"

#include <impactdic/error.h>

namespace impactdic {

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> infos;
  for (const opencl::Device& device : opencl::list_devices()) infos.push_back(device);
  return infos;
}

int choose_device(const std::string& device) {
  return opencl::choose_device(opencl::list_devices(), device).index;
}

void SessionOptions::validate() const {
  if (threads < 0 || threads > 1024) {
    throw InvalidArgument("the threads must be between 0 and 1024, not " + std::to_string(threads),
                          "--threads");
  }
  if (device.empty()) throw InvalidArgument("the device has no name", "--device");
}

std::vector<opencl::Engine*> Session::Impl::open_engines(const Expects& expects) {
  begun = true;
  const std::lock_guard<std::mutex> lock(mutex);
  if (engines.empty()) {
    opencl::EngineOptions engine_options;
    engine_options.profile = options.profile;
    engine_options.on_compile = options.on_compile;
    engine_options.expects = expects;
    if (options.device != "all") {
      engines.push_back(std::make_unique<opencl::Engine>(options.device, engine_options));
    } else {
      for (const opencl::Device& device : opencl::all_devices(opencl::list_devices())) {
        engines.push_back(
            std::make_unique<opencl::Engine>(std::to_string(device.index), engine_options));
        engine_options.expects = nullptr;  // what the first has compiled is there for all
      }
    }
  }
  opened.clear();
  std::vector<opencl::Engine*> all;
  for (const auto& engine : engines) {
    opened.push_back(engine->device());
    all.push_back(engine.get());
  }
  return all;
}

void Session::Impl::open_beside(Expects expects) {
  if (begun.exchange(true)) return;
  opening = std::async(std::launch::async, [this, expects = std::move(expects)] {
    try {
      open_engines(expects);
    } catch (const std::exception&) {
      // Who needs a device is told.
    }
  });
}

void Session::Impl::close_beside() {
  if (!for_one_run || options.profile) return;
  const std::lock_guard<std::mutex> lock(mutex);
  closing = std::async(std::launch::async, [all = std::move(engines)]() mutable { all.clear(); });
  engines.clear();
  begun = false;
}

Session::Session(SessionOptions options) : impl_(std::make_unique<Impl>()) {
  options.validate();
  if (options.threads > 0) {
    impl_->thread_limit.emplace(tbb::global_control::max_allowed_parallelism,
                                static_cast<std::size_t>(options.threads));
  }
  impl_->options = std::move(options);
}

Session::~Session() = default;
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;

const SessionOptions& Session::options() const { return impl_->options; }

void Session::open() { impl_->open_engines(); }

std::vector<DeviceInfo> Session::devices() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->opened;
}

std::string Session::profile() {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  std::string tables;
  for (const auto& engine : impl_->engines) {
    if (!engine->profiler().enabled()) continue;
    if (impl_->engines.size() > 1) tables += engine->device().name + "\n";
    tables += engine->profiler().table();
  }
  return tables;
}

}  // namespace impactdic
