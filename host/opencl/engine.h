// One OpenCL device ready for work: context, queue, compiled programs, profiler.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "host/opencl/cl.h"
#include "host/opencl/device.h"
#include "host/opencl/profiler.h"
#include "host/opencl/program_cache.h"

namespace impactdic {

struct EngineOptions {
  bool profile = false;
  // Repository root to load kernels from while working on them; "" takes $IMPACTDIC_KERNEL_DIR
  // where that is set, else the embedded sources.
  std::string kernel_dir;
  std::filesystem::path cache_dir = ProgramCache::default_folder();
};

// -D macros of a program, in order. Every macro is described in kernels/config.h.
using Defines = std::vector<std::pair<std::string, std::string>>;

// What a launch costs, for the profiler.
struct WorkCount {
  double bytes = 0, flops = 0;
};

// All members may be called from several threads; a cl::Kernel may not be shared between threads.
class Engine {
 public:
  // Throws InvalidArgument and OpenClError as choose_device does.
  explicit Engine(const std::string& device_spec = "auto", EngineOptions options = {});
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  const DeviceInfo& device() const { return device_; }
  const cl::Context& context() const { return context_; }
  // The in-order queue on which everything runs unless a caller has made its own.
  const cl::CommandQueue& queue() const { return queue_; }
  cl::CommandQueue make_queue() const;
  Profiler& profiler() { return profiler_; }

  // Kernel `name` of kernels/FILE compiled with `defines`: from memory, from the disk cache, or
  // compiled now. Throws BuildError with the log.
  cl::Kernel kernel(const std::string& file, const std::string& name, const Defines& defines = {});

  // Enqueues `kernel` and hands its event to the profiler. Global sizes must be multiples of the
  // local ones (see round_up). Throws OpenClError.
  void launch(const cl::CommandQueue& queue, const cl::Kernel& kernel, const cl::NDRange& global,
              const cl::NDRange& local, WorkCount work = {});

 private:
  cl::Program program(const std::string& file, const Defines& defines);
  cl::Program load_or_build(const std::string& source, const std::string& options,
                            const std::string& file);

  EngineOptions options_;
  DeviceInfo device_;
  cl::Context context_;
  cl::CommandQueue queue_;
  ProgramCache cache_;
  Profiler profiler_;
  std::mutex mutex_;
  std::map<std::string, cl::Program> programs_;
};

inline std::size_t round_up(std::size_t value, std::size_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

}  // namespace impactdic
