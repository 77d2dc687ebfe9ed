// Says at regular times that a process lives, as long as its work gets on.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace impactdic::cluster {

class Heartbeat {
 public:
  // Calls `beat` every `every_s` seconds from a thread of its own. Without `progressed` for
  // `silent_after_s` it falls silent, for a process whose work hangs does not live: a driver or a
  // file system that answers no more. What `beat` throws is as if it had been silent once.
  Heartbeat(std::function<void()> beat, double every_s, double silent_after_s);
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

  void progressed() { progress_.fetch_add(1, std::memory_order_relaxed); }

 private:
  void run(const std::stop_token& stop);
  std::function<void()> beat_;
  double every_s_, silent_after_s_;
  std::atomic<unsigned> progress_ = 0;
  std::mutex mutex_;
  std::condition_variable_any ended_;
  std::jthread thread_;
};

}  // namespace impactdic::cluster
