#include "host/base/stage_times.h"

#include <algorithm>
#include <cstdio>

namespace impactdic {

int StageTimes::add_stage(const std::string& name, int threads) {
  const std::lock_guard<std::mutex> lock(mutex_);
  rows_.push_back({name, std::max(threads, 1), 0});
  return static_cast<int>(rows_.size()) - 1;
}

void StageTimes::add(int stage, double seconds) {
  const std::lock_guard<std::mutex> lock(mutex_);
  rows_.at(static_cast<std::size_t>(stage)).busy_s += seconds;
}

std::vector<StageTimes::Row> StageTimes::rows() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return rows_;
}

std::string StageTimes::table(double wall_s, std::int64_t frames) const {
  char line[160];
  std::snprintf(line, sizeof line, "%-26s %8s %11s %10s %8s\n", "stage", "threads", "us a frame",
                "busy ms", "busy %");
  std::string text = line;
  for (const Row& row : rows()) {
    std::snprintf(line, sizeof line, "%-26s %8d %11.1f %10.1f %8.1f\n", row.name.c_str(),
                  row.threads,
                  row.busy_s * 1e6 / static_cast<double>(std::max<std::int64_t>(frames, 1)),
                  row.busy_s * 1e3, 100 * row.busy_s / (wall_s * row.threads));
    text += line;
  }
  return text;
}

}  // namespace impactdic
