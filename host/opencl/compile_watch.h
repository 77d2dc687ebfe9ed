// Tells a caller how far the compiler is: kernels that this machine has not compiled before take
// seconds, and whoever waits should know why.
#pragma once

#include <impactdic/device.h>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "host/opencl/cl.h"

namespace impactdic::opencl {

class CompileWatch : public std::enable_shared_from_this<CompileWatch> {
 public:
  // Nobody is told where `tell` is empty.
  explicit CompileWatch(CompileFn tell) : tell_(std::move(tell)) {}

  // A kernel that is compiled at once: before and after.
  void begin(const std::string& kernel);
  void end(const std::string& kernel);
  // The same for as long as the object lives.
  class Step {
   public:
    Step(CompileWatch& watch, const std::string& kernel) : watch_(watch), kernel_(kernel) {
      watch_.begin(kernel_);
    }
    ~Step() { watch_.end(kernel_); }
    Step(const Step&) = delete;
    Step& operator=(const Step&) = delete;

   private:
    CompileWatch& watch_;
    std::string kernel_;
  };
  // A kernel that its driver compiles when it first runs. `key`: the same for all of its objects.
  void await(const cl::Kernel& object, const std::string& key, const std::string& kernel);
  // Any kernel was enqueued; `event` is that of the launch.
  void launched(const cl::Kernel& object, const cl::Event& event);

 private:
  struct Awaited {
    std::string key, kernel;
  };
  void count(const std::string& kernel, int known, int done);

  CompileFn tell_;
  std::mutex mutex_;
  int done_ = 0, known_ = 0;
  std::atomic<bool> awaits_ = false;
  std::map<cl_kernel, Awaited> objects_;
  std::set<std::string> asked_, waiting_;  // keys
};

}  // namespace impactdic::opencl
