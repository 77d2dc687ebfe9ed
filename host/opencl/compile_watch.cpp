#include "host/opencl/compile_watch.h"

namespace impactdic::opencl {

void CompileWatch::count(const std::string& kernel, int known, int done) {
  if (!tell_) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  known_ += known;
  done_ += done;
  tell_({kernel, done_, known_});
}

void CompileWatch::begin(const std::string& kernel) { count(kernel, 1, 0); }
void CompileWatch::end(const std::string& kernel) { count(kernel, 0, 1); }

void CompileWatch::await(const cl::Kernel& object, const std::string& key,
                         const std::string& kernel) {
  if (!tell_) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const bool is_new = asked_.insert(key).second;
    if (is_new) waiting_.insert(key);
    if (waiting_.count(key) == 0) return;
    objects_[object()] = {key, kernel};
    awaits_ = true;
    if (!is_new) return;
  }
  begin(kernel);
}

void CompileWatch::launched(const cl::Kernel& object, const cl::Event& event) {
  if (!awaits_) return;
  std::string kernel;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = objects_.find(object());
    if (found == objects_.end()) return;
    const Awaited awaited = found->second;
    objects_.erase(found);
    awaits_ = !objects_.empty();
    if (waiting_.erase(awaited.key) == 0) return;
    kernel = awaited.kernel;
  }
  // The driver's thread may run this after the engine is gone.
  struct Ran {
    std::shared_ptr<CompileWatch> watch;
    std::string kernel;
  };
  auto ran = std::make_unique<Ran>(Ran{shared_from_this(), kernel});
  const auto tell = [](cl_event, cl_int, void* data) {
    const std::unique_ptr<Ran> owned(static_cast<Ran*>(data));
    owned->watch->end(owned->kernel);
  };
  if (clSetEventCallback(event(), CL_COMPLETE, tell, ran.get()) == CL_SUCCESS) {
    ran.release();
  } else {
    end(kernel);
  }
}

}  // namespace impactdic::opencl
