// A run's way to its caller: one thread at a time.
#pragma once

#include <impactdic/control.h>

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>

namespace impactdic::run {

class Caller {
 public:
  explicit Caller(const RunControl& control) : control_(control) {}

  void progress(const char* phase, std::int64_t done, std::int64_t total) {
    if (!control_.progress) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    control_.progress({phase, done, total});
  }
  void say(MessageKind kind, std::string text) {
    if (!control_.message || text.empty()) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    control_.message({kind, std::move(text)});
  }
  // Stays true once it is. Asked often, by threads that have work to do: while another talks to the
  // caller it does not wait.
  bool cancelled() {
    if (!control_.cancelled) return false;
    if (!cancelled_) {
      const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
      if (lock && control_.cancelled()) cancelled_ = true;
    }
    return cancelled_;
  }

 private:
  const RunControl& control_;
  std::mutex mutex_;
  std::atomic<bool> cancelled_ = false;
};

}  // namespace impactdic::run
