#include "host/opencl/engine.h"

#include <cstdlib>

#include "host/base/error.h"
#include "host/base/log.h"
#include "host/opencl/kernel_source.h"

namespace impactdic {
namespace {

// OpenCL C 1.2 is what every vendor has. No fast-math: sub-pixel results must not lose bits.
constexpr const char* kBaseOptions = "-cl-std=CL1.2";

std::string build_options(const Defines& defines) {
  std::string options = kBaseOptions;
  for (const auto& [name, value] : defines) options += " -D" + name + "=" + value;
  return options;
}

}  // namespace

Engine::Engine(const std::string& device_spec, EngineOptions options)
    : options_(std::move(options)),
      device_(choose_device(list_devices(), device_spec)),
      cache_(options_.cache_dir),
      profiler_(options_.profile) {
  if (options_.kernel_dir.empty()) {
    if (const char* folder = std::getenv("IMPACTDIC_KERNEL_DIR")) options_.kernel_dir = folder;
  }
  try {
    context_ = cl::Context(device_.handle);
    queue_ = make_queue();
  } catch (const cl::Error& error) {
    throw OpenClError(error.what(), error.err());
  }
}

cl::CommandQueue Engine::make_queue() const {
  return cl::CommandQueue(
      context_, device_.handle,
      options_.profile ? cl::QueueProperties::Profiling : cl::QueueProperties::None);
}

cl::Kernel Engine::kernel(const std::string& file, const std::string& name,
                          const Defines& defines) {
  try {
    return cl::Kernel(program(file, defines), name.c_str());
  } catch (const cl::Error& error) {
    throw OpenClError(std::string(error.what()) + " " + file + ":" + name, error.err());
  }
}

cl::Program Engine::program(const std::string& file, const Defines& defines) {
  const std::string options = build_options(defines);
  const std::string key = file + "\n" + options;
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = programs_.find(key);
  if (found != programs_.end()) return found->second;
  const cl::Program made = load_or_build(kernel_source(file, options_.kernel_dir), options, file);
  programs_.emplace(key, made);
  return made;
}

cl::Program Engine::load_or_build(const std::string& source, const std::string& options,
                                  const std::string& file) {
  const std::string key = device_.platform + "\n" + device_.name + "\n" + device_.version + "\n" +
                          device_.driver + "\n" + options + "\n" + source;
  if (auto binary = cache_.load(key)) {
    try {
      cl::Program cached(context_, {device_.handle}, {*binary});
      cached.build(options.c_str());
      return cached;
    } catch (const cl::Error&) {
      cache_.remove(key);  // the driver does not take it: compile afresh below
    }
  }
  cl::Program program(context_, source);
  try {
    program.build(options.c_str());
  } catch (const cl::Error&) {
    const std::string log = program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device_.handle);
    throw BuildError("kernel does not compile: " + log,
                     "kernels/" + file + " on " + device_.name + " with " + options);
  }
  spdlog::debug("compiled kernels/{} {}", file, options);
  const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
  if (!binaries.empty() && !binaries[0].empty()) cache_.store(key, binaries[0]);
  return program;
}

void Engine::launch(const cl::CommandQueue& queue, const cl::Kernel& kernel,
                    const cl::NDRange& global, const cl::NDRange& local, WorkCount work) {
  const auto name = [&kernel] {
    return std::string(kernel.getInfo<CL_KERNEL_FUNCTION_NAME>().c_str());
  };
  try {
    cl::Event event;
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, global, local, nullptr, &event);
    if (profiler_.enabled()) profiler_.add(name(), event, work.bytes, work.flops);
  } catch (const cl::Error& error) {
    throw OpenClError(std::string(error.what()) + " " + name(), error.err());
  }
}

}  // namespace impactdic
