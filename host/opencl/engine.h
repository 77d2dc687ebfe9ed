// One OpenCL device ready for work: context, queue, compiled programs, profiler.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/opencl/ahead/compile_ahead.h"
#include "host/opencl/cl.h"
#include "host/opencl/compile_watch.h"
#include "host/opencl/device.h"
#include "host/opencl/memory.h"
#include "host/opencl/profiler.h"
#include "host/opencl/program_cache.h"

namespace impactdic::opencl {

class Engine;

// -D macros of a program, in order. Every macro is described in kernels/config.h.
using Defines = std::vector<std::pair<std::string, std::string>>;

// kernels/FILE compiled with these macros and further options for the compiler.
struct ProgramRequest {
  std::string file;
  Defines defines = {};
  std::string options = {};
  bool is_sure = true;  // of those that are expected: false where it may not be asked for
};

struct EngineOptions {
  bool profile = false;
  // Repository root to load kernels from while working on them; "" takes $IMPACTDIC_KERNEL_DIR
  // where that is set, else the embedded sources.
  std::string kernel_dir;
  std::filesystem::path cache_dir = ProgramCache::default_folder();
  // Whether compiled programs are kept there. Without a value: unless the driver keeps them itself
  // (Device::keeps_programs).
  std::optional<bool> keep_programs = std::nullopt;
  // Of device and page-locked memory, as much is kept for later when nobody uses it any more.
  // Without a value: a quarter of a GPU's memory.
  std::optional<std::size_t> kept_memory_bytes = std::nullopt;
  // Told how far the compiler is, where there is something to compile.
  CompileFn on_compile = nullptr;
  // The programs that will be asked for, those that take longest first, and last those that may be.
  // Where other processes can compile them sooner they begin with what is not in the cache yet,
  // beside the opening of the device. Called on another thread while the constructor runs, for an
  // engine that knows its device and cache folder and can do nothing yet; what it throws means
  // none. It may be empty.
  std::function<std::vector<ProgramRequest>(const Engine&)> expects = nullptr;
  // How many processes at most, of which program, "" for the one that is installed. Without a
  // number: $IMPACTDIC_COMPILERS, else as many as help (on a GPU whose driver compiles one program
  // at a time in a process). A number above 0 has binaries kept on any device.
  std::optional<int> compilers = std::nullopt;
  std::string compiler_program;
};

// What a launch costs, for the profiler.
struct WorkCount {
  double bytes = 0, flops = 0;
};

// Thrown out of work that the function of Engine::stop_when has stopped.
struct Stopped {};

// All members may be called from several threads; a cl::Kernel may not be shared between threads.
class Engine {
 public:
  // Throws InvalidArgument and OpenClError as choose_device does.
  explicit Engine(const std::string& device_spec = "auto", EngineOptions options = {});
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  // The same device, programs and profiler behind a queue of its own: what one engine enqueues
  // runs beside what the other does.
  std::unique_ptr<Engine> beside() const;
  // How many engines there are on this one's context, itself among them.
  int count() const { return shared_->engines; }

  const Device& device() const { return shared_->device; }
  const cl::Context& context() const { return shared_->context; }
  // Memory for what runs on `queue()`, with undefined contents. Throws cl::Error.
  Memory allocate(std::size_t bytes, cl_mem_flags flags) const {
    return shared_->memory->take(bytes, flags, queue_);
  }
  const MemoryPool& memory() const { return *shared_->memory; }
  // The in-order queue on which everything runs unless a caller has made its own.
  const cl::CommandQueue& queue() const { return queue_; }
  cl::CommandQueue make_queue() const;
  // Returns when everything enqueued on `queue` is done, or what `event` stands for. The thread
  // sleeps meanwhile: left to themselves, drivers of GPUs keep its core busy. Throws OpenClError.
  void wait() const;
  void wait(const cl::Event& event) const;
  // The same for who is about to free what the device may still read or write, whatever became of
  // it.
  void settle() const noexcept;
  Profiler& profiler() { return shared_->profiler; }
  // Where compiled programs and the result of `impactdic tune` are kept; empty: nowhere.
  const std::filesystem::path& cache_dir() const { return shared_->options.cache_dir; }

  // Kernel `name` of kernels/FILE compiled with `defines`: from memory, from the disk cache, or
  // compiled now. `options`: further ones for the compiler. Throws BuildError with the log.
  cl::Kernel kernel(const ProgramRequest& program, const std::string& name);
  cl::Kernel kernel(const std::string& file, const std::string& name, const Defines& defines = {},
                    const std::string& options = "") {
    return kernel(ProgramRequest{file, defines, options}, name);
  }
  // The program alone, with all of its options as the compiler gets them.
  void compile(const std::string& file, const std::string& options) { program(file, options); }

  // From now on `launch` throws Stopped once `stopped` says so. Of this engine alone, not of those
  // beside it; before other threads use it. `stopped` may be empty, and must not throw.
  void stop_when(std::function<bool()> stopped) { stopped_ = std::move(stopped); }
  // Of `count` independent pieces of work over so many pixels each, how many one launch takes: all
  // on a GPU. A processor gets an even number, some tenths of a second's work, so that it can be
  // stopped between two launches.
  std::size_t at_once(std::size_t count, double pixels) const;

  // Enqueues `kernel` and hands its event to the profiler. Global sizes must be multiples of the
  // local ones (see round_up). Throws OpenClError, and Stopped as `stop_when` says.
  void launch(const cl::CommandQueue& queue, const cl::Kernel& kernel, const cl::NDRange& global,
              const cl::NDRange& local, WorkCount work = {});

 private:
  struct Program {
    cl::Program program;
    bool to_compile = false;  // its driver compiles its kernels when they first run
  };
  // What all engines beside each other have in common.
  struct Shared {
    EngineOptions options;
    Device device;
    cl::Context context;
    std::shared_ptr<MemoryPool> memory;
    ProgramCache cache;
    Profiler profiler;
    std::mutex mutex;
    std::map<std::string, Program> programs;
    std::vector<cl::CommandQueue> idle_queues;  // of engines that are gone
    std::atomic<int> engines = 0;
    std::shared_ptr<CompileWatch> compiling;
    bool keeps_binaries = true;
    std::atomic<bool> compiler_is_stuck = false;
    std::optional<CompileAhead> ahead;
    void check_compiler() const;  // throws OpenClError
    Shared(const Device& info, EngineOptions asked);
    void open();
    std::string key_of(const std::string& source, const std::string& program_options) const;
    // Starts whoever compiles them elsewhere.
    void begin_ahead(const std::vector<ProgramRequest>& programs, int compilers);
  };
  struct Unopened {};
  Engine(std::shared_ptr<Shared> shared, Unopened) : shared_(std::move(shared)) {}
  explicit Engine(std::shared_ptr<Shared> shared);
  static std::shared_ptr<Shared> open(const Device& device, EngineOptions options);
  Program program(const std::string& file, const std::string& options);
  Program load_or_build(const std::string& source, const std::string& options,
                        const std::string& file);
  cl::Program build(const std::string& source, const std::string& options, const std::string& file);

  std::shared_ptr<Shared> shared_;
  cl::CommandQueue queue_;
  std::function<bool()> stopped_;
};

// Where an exception leaves a scope before its work on the device was waited for, waits: until then
// the device reads and writes memory of the host that goes away with the scope, or with an object.
class Settled {
 public:
  explicit Settled(const Engine& engine) : engine_(&engine) {}
  ~Settled() {
    if (engine_ != nullptr) engine_->settle();
  }
  Settled(const Settled&) = delete;
  Settled& operator=(const Settled&) = delete;
  // It was waited for.
  void done() { engine_ = nullptr; }

 private:
  const Engine* engine_;
};

inline std::size_t round_up(std::size_t value, std::size_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

}  // namespace impactdic::opencl
