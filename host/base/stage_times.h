// Where the time of a pipeline goes: how long every stage was busy.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "host/base/stopwatch.h"

namespace impactdic {

class StageTimes {
 public:
  // Names a stage in the order of the work. `threads`: how many can work on it at once.
  // Returns its number.
  int add_stage(const std::string& name, int threads);
  // Notes that a thread worked for `seconds` on `stage`. Safe on several threads.
  void add(int stage, double seconds);

  struct Row {
    std::string name;
    int threads = 1;
    double busy_s = 0;  // all threads together
  };
  std::vector<Row> rows() const;
  // Stage, threads, time busy, time a frame, and the share of `wall_s` that its threads were busy:
  // the slowest stage is the one next to 100 %.
  std::string table(double wall_s, std::int64_t frames) const;

  // Times a scope.
  class Scope {
   public:
    Scope(StageTimes* times, int stage) : times_(times), stage_(stage) {}
    ~Scope() {
      if (times_ != nullptr) times_->add(stage_, watch_.seconds());
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    StageTimes* times_;
    int stage_;
    Stopwatch watch_;
  };

 private:
  mutable std::mutex mutex_;
  std::vector<Row> rows_;
};

}  // namespace impactdic
