#include "host/cluster/heartbeat.h"

#include <chrono>
#include <exception>
#include <utility>

namespace impactdic::cluster {

Heartbeat::Heartbeat(std::function<void()> beat, double every_s, double silent_after_s)
    : beat_(std::move(beat)),
      every_s_(every_s),
      silent_after_s_(silent_after_s),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Heartbeat::~Heartbeat() {
  thread_.request_stop();
  thread_.join();
}

void Heartbeat::run(const std::stop_token& stop) {
  using Clock = std::chrono::steady_clock;
  const auto seconds = [](double s) { return std::chrono::duration<double>(s); };
  unsigned known = progress_;
  auto since = Clock::now();
  std::unique_lock lock(mutex_);
  while (!ended_.wait_for(lock, stop, seconds(every_s_), [&] { return stop.stop_requested(); })) {
    const unsigned now = progress_;
    if (now != known) {
      known = now;
      since = Clock::now();
    }
    if (Clock::now() - since > seconds(silent_after_s_)) continue;
    try {
      beat_();
    } catch (const std::exception&) {
      // The file system may answer the next one.
    }
  }
}

}  // namespace impactdic::cluster
