// Device time of every kernel and copy, from OpenCL's event counters.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "host/opencl/cl.h"

namespace impactdic::opencl {

struct ProfileRow {
  std::string name;
  std::size_t calls = 0;
  double median_s = 0, total_s = 0;
  double bytes = 0, flops = 0;  // sums over the calls, as the launcher counted them
};

class Profiler {
 public:
  explicit Profiler(bool enabled) : enabled_(enabled) {}
  bool enabled() const { return enabled_; }
  // Keeps the event until it is read out; bytes and flops are the launcher's count of the work.
  void add(const std::string& name, const cl::Event& event, double bytes = 0, double flops = 0);
  // Waits for the events kept and sums them up by name, longest total first.
  std::vector<ProfileRow> rows();
  // The rows as a table for a terminal: kernel, calls, median time, bytes, FLOPs and their rates.
  std::string table();

 private:
  struct Entry {
    std::vector<double> seconds;
    std::vector<cl::Event> pending;
    std::size_t settle_at = 0;  // events pending
    double bytes = 0, flops = 0;
  };
  // Reads out the events that are done. It waits for none: that one's owner may be waiting here.
  static void settle(Entry& entry);
  bool enabled_;
  std::mutex mutex_;
  std::map<std::string, Entry> entries_;
};

}  // namespace impactdic::opencl
