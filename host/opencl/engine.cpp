#include "host/opencl/engine.h"

#include <impactdic/error.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <future>
#include <memory>
#include <thread>

#include "host/base/log.h"
#include "host/base/parse.h"
#include "host/base/private_folder.h"
#include "host/base/process/helper_program.h"
#include "host/opencl/kernel_source.h"

namespace impactdic::opencl {
namespace {

// OpenCL C 1.2 is what every vendor has. No fast-math: sub-pixel results must not lose bits.
constexpr const char* kBaseOptions = "-cl-std=CL1.2";

// What a processor is given at a time: 4700 windows of 15 × 15 px.
constexpr double kPixelsAtOnce = 1 << 20;

std::string build_options(const ProgramRequest& program) {
  std::string options = kBaseOptions;
  // For whoever works on a kernel: "-cl-nv-verbose" and the like.
  if (const char* further = std::getenv("IMPACTDIC_BUILD_OPTIONS")) {
    options += std::string(" ") + further;
  }
  for (const auto& [name, value] : program.defines)
    options.append(" -D").append(name).append("=").append(value);
  if (!program.options.empty()) options.append(" ").append(program.options);
  return options;
}

// Processes that compile ahead. More of them only wait for each other: each opens the device, which
// a driver does for one at a time.
int count_compilers(const Device& device, const EngineOptions& options) {
  constexpr int kMost = 6, kMostAsked = 64;
  constexpr std::size_t kBytesEach = std::size_t{2} << 30;  // of the device's memory, for a quarter
  if (options.compilers) return *options.compilers;
  if (const char* asked = std::getenv("IMPACTDIC_COMPILERS")) {
    const std::int64_t count = parse_int(asked, "IMPACTDIC_COMPILERS");
    if (count < 0 || count > kMostAsked) {
      throw InvalidArgument("must be a number from 0 to " + std::to_string(kMostAsked),
                            "IMPACTDIC_COMPILERS");
    }
    return static_cast<int>(count);
  }
  if (!device.is_gpu || device.vendor.find("NVIDIA") == std::string::npos) return 0;
  const auto threads = static_cast<int>(std::thread::hardware_concurrency());
  const auto by_memory =
      static_cast<int>(std::min<std::size_t>(device.global_memory_bytes / kBytesEach, kMost));
  return std::min({kMost, threads / 2, by_memory});
}

}  // namespace

Engine::Shared::Shared(const Device& info, EngineOptions asked)
    : options(std::move(asked)),
      device(info),
      cache(options.cache_dir),
      profiler(options.profile),
      compiling(std::make_shared<CompileWatch>(options.on_compile)),
      keeps_binaries(options.keep_programs.value_or(!info.keeps_programs)) {
  if (options.kernel_dir.empty()) {
    if (const char* folder = std::getenv("IMPACTDIC_KERNEL_DIR")) options.kernel_dir = folder;
  }
}

void Engine::Shared::open() {
  try {
    context = cl::Context(device.handle);
  } catch (const cl::Error& error) {
    throw OpenClError(error.what(), error.err());
  }
  const std::size_t kept = device.is_gpu ? device.global_memory_bytes / 4 : 0;
  memory = std::make_shared<MemoryPool>(context, options.kept_memory_bytes.value_or(kept));
}

std::string Engine::Shared::key_of(const std::string& source,
                                   const std::string& program_options) const {
  return device.platform + "\n" + device.name + "\n" + device.version + "\n" + device.driver +
         "\n" + program_options + "\n" + source;
}

void Engine::Shared::begin_ahead(const std::vector<ProgramRequest>& programs, int compilers) {
  AheadHelpers helpers;
  helpers.program = options.compiler_program.empty() ? helper_program("impactdic-compile")
                                                     : options.compiler_program;
  helpers.count = compilers;
  helpers.device = device.index;
  helpers.cache = options.cache_dir;
  helpers.kernel_dir = options.kernel_dir;
  helpers.keeps_binaries = keeps_binaries;
  std::vector<AheadTask> tasks;
  std::size_t sure = 0;
  for (const ProgramRequest& program : programs) {
    AheadTask task = {"", program.file, build_options(program), program.is_sure};
    task.key = key_of(kernel_source(program.file, options.kernel_dir), task.options);
    if (cache.load(task.key)) continue;
    sure += program.is_sure ? 1 : 0;
    tasks.push_back(std::move(task));
  }
  std::stable_partition(tasks.begin(), tasks.end(),
                        [](const AheadTask& task) { return task.is_sure; });
  // A single one is compiled as soon by whoever asks for it.
  if (sure == 0 || tasks.size() < 2 || helpers.program.empty() ||
      !make_private_folder(helpers.cache))
    return;
  ahead.emplace(helpers, std::move(tasks));
}

std::shared_ptr<Engine::Shared> Engine::open(const Device& device, EngineOptions options) {
  const int most = count_compilers(device, options);
  const int compilers = options.expects && !options.cache_dir.empty() ? most : 0;
  if (compilers > 0) options.keep_programs = true;
  auto shared = std::make_shared<Shared>(device, std::move(options));
  std::future<void> beginning;
  if (compilers > 0) {
    beginning = std::async(std::launch::async, [&shared, compilers] {
      try {
        const Engine unopened(shared, Unopened());
        shared->begin_ahead(shared->options.expects(unopened), compilers);
      } catch (const std::exception&) {
        // Then nobody compiles ahead.
      }
    });
  }
  shared->open();
  if (beginning.valid()) beginning.get();
  return shared;
}

Engine::Engine(const std::string& device_spec, EngineOptions options)
    : Engine(open(choose_device(list_devices(), device_spec), std::move(options))) {}

Engine::Engine(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {
  {
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    if (!shared_->idle_queues.empty()) {
      queue_ = std::move(shared_->idle_queues.back());
      shared_->idle_queues.pop_back();
    }
  }
  try {
    if (queue_() == nullptr) queue_ = make_queue();
  } catch (const cl::Error& error) {
    throw OpenClError(error.what(), error.err());
  }
  ++shared_->engines;
}

Engine::~Engine() {
  if (queue_() == nullptr) return;  // it was never open
  --shared_->engines;
  const std::lock_guard<std::mutex> lock(shared_->mutex);
  shared_->idle_queues.push_back(queue_);
}

std::unique_ptr<Engine> Engine::beside() const {
  return std::unique_ptr<Engine>(new Engine(shared_));
}

cl::CommandQueue Engine::make_queue() const {
  return cl::CommandQueue(
      shared_->context, shared_->device.handle,
      shared_->options.profile ? cl::QueueProperties::Profiling : cl::QueueProperties::None);
}

void Engine::wait() const {
  try {
    if (!device().is_gpu) {
      queue_.finish();
      return;
    }
    cl::Event reached;
    queue_.enqueueMarkerWithWaitList(nullptr, &reached);
    wait(reached);
  } catch (const cl::Error& error) {
    throw OpenClError(error.what(), error.err());
  }
}

void Engine::wait(const cl::Event& event) const {
  constexpr auto kNap = std::chrono::microseconds(20);
  const auto done = [&event] {
    const cl_int status = event.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>();
    if (status < 0) throw OpenClError("a kernel or copy failed", status);
    return status == CL_COMPLETE;
  };
  try {
    if (done()) return;
    if (!device().is_gpu) {
      event.wait();
      return;
    }
    queue_.flush();
    while (!done()) std::this_thread::sleep_for(kNap);
  } catch (const cl::Error& error) {
    throw OpenClError(error.what(), error.err());
  }
}

void Engine::settle() const noexcept {
  try {
    queue_.finish();
  } catch (const cl::Error&) {
    // A device that is lost does nothing any more.
  }
}

void Engine::Shared::check_compiler() const {
  if (compiler_is_stuck) {
    throw OpenClError("the device's compiler ran out of memory", CL_OUT_OF_HOST_MEMORY);
  }
}

cl::Kernel Engine::kernel(const ProgramRequest& request, const std::string& name) {
  const std::string& file = request.file;
  try {
    const std::string all = build_options(request);
    const Program made = program(file, all);
    cl::Kernel kernel(made.program, name.c_str());
    if (made.to_compile) {
      shared_->compiling->await(kernel, file + ":" + name + "\n" + all, file + ":" + name);
    }
    return kernel;
  } catch (const cl::Error& error) {
    throw OpenClError(std::string(error.what()) + " " + file + ":" + name, error.err());
  }
}

Engine::Program Engine::program(const std::string& file, const std::string& options) {
  const std::string key = file + "\n" + options;
  const std::lock_guard<std::mutex> lock(shared_->mutex);
  shared_->check_compiler();
  const auto found = shared_->programs.find(key);
  if (found != shared_->programs.end()) return found->second;
  Program made = load_or_build(kernel_source(file, shared_->options.kernel_dir), options, file);
  shared_->programs.emplace(key, made);
  return made;
}

Engine::Program Engine::load_or_build(const std::string& source, const std::string& options,
                                      const std::string& file) {
  const std::string key = shared_->key_of(source, options);
  auto binary = shared_->cache.load(key);
  if (!shared_->keeps_binaries) {
    // The entry only says that this machine has met the program: asked for a binary, PoCL would
    // compile all of its kernels a second time, for groups of any size.
    Program made = {build(source, options, file), !binary};
    if (!binary) shared_->cache.store(key, {1});
    return made;
  }
  std::optional<CompileWatch::Step> step;
  if (!binary) step.emplace(*shared_->compiling, file);
  if (!binary && shared_->ahead) {
    shared_->ahead->await(key, shared_->cache.path_of(key));
    binary = shared_->cache.load(key);
  }
  if (binary) {
    try {
      cl::Program cached(shared_->context, {shared_->device.handle}, {*binary});
      cached.build(options.c_str());
      return {cached};
    } catch (const cl::Error&) {
      shared_->cache.remove(key);  // the driver does not take it: compile afresh below
    }
  }
  if (!step) step.emplace(*shared_->compiling, file);
  Program made = {build(source, options, file)};
  const auto binaries = made.program.getInfo<CL_PROGRAM_BINARIES>();
  if (!binaries.empty() && !binaries[0].empty()) shared_->cache.store(key, binaries[0]);
  return made;
}

cl::Program Engine::build(const std::string& source, const std::string& options,
                          const std::string& file) {
  // Out of memory, PoCL's compiler throws through the library and leaves its locks closed: whoever
  // compiles or releases a program then waits for ever. So nobody does.
  struct Held {
    cl::Program program;
    std::shared_ptr<Shared> shared;
  };
  auto held = std::make_unique<Held>(Held{cl::Program(shared_->context, source), shared_});
  const cl::Program& program = held->program;
  try {
    held->program.build(options.c_str());
  } catch (const cl::Error&) {
    const std::string log = program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(shared_->device.handle);
    throw BuildError("kernel does not compile: " + log,
                     "kernels/" + file + " on " + shared_->device.name + " with " + options);
  } catch (const std::exception&) {
    shared_->compiler_is_stuck = true;
    static_cast<void>(held.release());
    throw;
  }
  library_log().debug("compiled kernels/{} {} {}", file, options,
                      program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(shared_->device.handle));
  return program;
}

std::size_t Engine::at_once(std::size_t count, double pixels) const {
  if (device().is_gpu) return count;
  const double some = std::clamp(kPixelsAtOnce / std::max(pixels, 1.0) / 2, 1.0, 1e9);
  return std::min(count, 2 * static_cast<std::size_t>(some));
}

void Engine::launch(const cl::CommandQueue& queue, const cl::Kernel& kernel,
                    const cl::NDRange& global, const cl::NDRange& local, WorkCount work) {
  const auto name = [&kernel] { return kernel.getInfo<CL_KERNEL_FUNCTION_NAME>(); };
  shared_->check_compiler();
  if (stopped_ && stopped_()) throw Stopped();
  try {
    cl::Event event;
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, global, local, nullptr, &event);
    shared_->compiling->launched(kernel, event);
    if (shared_->profiler.enabled()) shared_->profiler.add(name(), event, work.bytes, work.flops);
  } catch (const cl::Error& error) {
    throw OpenClError(std::string(error.what()) + " " + name(), error.err());
  }
}

}  // namespace impactdic::opencl
