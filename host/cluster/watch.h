// Who of the others still works.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

namespace impactdic::cluster {

// Seconds of a clock that only goes on.
using Clock = std::function<double()>;

// Every member of a share writes a beat now and then: who it is, and a number that grows. What
// counts is when the watcher saw it change, by its own clock: the clocks of machines need not
// agree.
class Watch {
 public:
  // `gone`: whether a beat's process certainly runs no more (is_gone of its text).
  Watch(double lost_after_s, Clock clock, std::function<bool(const std::string&)> gone);

  // Whether `member`, whose beat now reads `beat` (nothing where there is none), is to be given up.
  bool is_lost(const std::string& member, const std::optional<std::string>& beat);

 private:
  struct Seen {
    std::optional<std::string> beat;
    double since_s = 0;
  };
  double lost_after_s_;
  Clock clock_;
  std::function<bool(const std::string&)> gone_;
  std::map<std::string, Seen> seen_;
};

}  // namespace impactdic::cluster
