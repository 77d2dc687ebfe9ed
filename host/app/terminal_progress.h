// Progress of a long run as a person at a terminal sees it.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace impactdic::app {

// One rewritten line on stderr: frames done, %, frames/s, time left. Only on a terminal.
class TerminalProgress {
 public:
  // `quiet` silences it whatever stderr is.
  explicit TerminalProgress(std::string label, bool quiet = false);
  ~TerminalProgress();
  void operator()(std::int64_t done, std::int64_t total);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  bool shown_;
  bool drawn_ = false;
  Clock::time_point start_, last_;
};

}  // namespace impactdic::app
