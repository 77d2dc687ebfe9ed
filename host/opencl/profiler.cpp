#include "host/opencl/profiler.h"

#include <algorithm>
#include <cstdio>

#include "host/base/statistics.h"

namespace impactdic::opencl {

namespace {
// A long clip makes millions of events: they are read out before they pile up.
constexpr std::size_t kMaxPending = 1024;
}  // namespace

void Profiler::settle(Entry& entry) {
  std::erase_if(entry.pending, [&](const cl::Event& event) {
    if (event.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>() != CL_COMPLETE) return false;
    const auto start = event.getProfilingInfo<CL_PROFILING_COMMAND_START>();
    const auto end = event.getProfilingInfo<CL_PROFILING_COMMAND_END>();
    entry.seconds.push_back(static_cast<double>(end - start) * 1e-9);
    return true;
  });
  entry.settle_at = entry.pending.size() + kMaxPending;
}

void Profiler::add(const std::string& name, const cl::Event& event, double bytes, double flops) {
  if (!enabled_) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  Entry& entry = entries_[name];
  entry.pending.push_back(event);
  entry.bytes += bytes;
  entry.flops += flops;
  if (entry.pending.size() >= std::max(entry.settle_at, kMaxPending)) settle(entry);
}

std::vector<ProfileRow> Profiler::rows() {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<ProfileRow> rows;
  for (auto& [name, entry] : entries_) {
    for (const cl::Event& event : entry.pending) event.wait();
    settle(entry);
    ProfileRow row{name, entry.seconds.size(), 0, 0, entry.bytes, entry.flops};
    if (!entry.seconds.empty()) row.median_s = upper_median(entry.seconds);
    for (double s : entry.seconds) row.total_s += s;
    rows.push_back(row);
  }
  std::sort(rows.begin(), rows.end(),
            [](const ProfileRow& a, const ProfileRow& b) { return a.total_s > b.total_s; });
  return rows;
}

std::string Profiler::table() {
  char line[200];
  std::snprintf(line, sizeof line, "%-26s %8s %11s %10s %10s %8s %10s %9s\n", "kernel", "calls",
                "median us", "total ms", "MB", "GB/s", "MFLOP", "GFLOP/s");
  std::string text = line;
  for (const ProfileRow& row : rows()) {
    const double giga_per_s = row.total_s > 0 ? 1e-9 / row.total_s : 0;
    std::snprintf(line, sizeof line, "%-26s %8zu %11.1f %10.2f %10.2f %8.2f %10.1f %9.2f\n",
                  row.name.c_str(), row.calls, row.median_s * 1e6, row.total_s * 1e3,
                  row.bytes * 1e-6, row.bytes * giga_per_s, row.flops * 1e-6,
                  row.flops * giga_per_s);
    text += line;
  }
  return text;
}

}  // namespace impactdic::opencl
