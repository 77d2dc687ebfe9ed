#include "host/python/job.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

namespace nb = nanobind;

namespace impactdic::python {
namespace {

// How long Ctrl-C may go unnoticed.
constexpr std::chrono::milliseconds kLook{50};

const char* word_of(MessageKind kind) {
  switch (kind) {
    case MessageKind::kNote:
      return "note";
    case MessageKind::kWarning:
      return "warning";
    case MessageKind::kTiming:
      return "timing";
  }
  return "";
}

// Work in a thread of its own, which must not be left before it is done.
class Beside {
 public:
  explicit Beside(std::function<void()> work)
      : thread_([this, work = std::move(work)] {
          try {
            work();
          } catch (...) {
            error_ = std::current_exception();
          }
          const std::lock_guard lock(mutex_);
          done_ = true;
          changed_.notify_all();
        }) {}
  ~Beside() { thread_.join(); }
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;

  bool wait_for(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, time, [this] { return done_; });
  }
  const std::exception_ptr& error() const { return error_; }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;
  std::exception_ptr error_;
  std::thread thread_;  // the last member: it uses the others
};

}  // namespace

RunControl Job::control() {
  RunControl control;
  control.cancelled = [this] { return cancelled_.load(); };
  if (!listeners_.progress.is_none()) {
    control.progress = [this](const Progress& progress) {
      const nb::gil_scoped_acquire gil;
      listeners_.progress(progress.phase, progress.done, progress.total);
    };
  }
  if (!listeners_.message.is_none()) {
    control.message = [this](const Message& message) {
      const nb::gil_scoped_acquire gil;
      listeners_.message(word_of(message.kind), message.text.c_str());
    };
  }
  return control;
}

// Python's own handlers run here, which is where they may. Only in the main thread do they.
void Job::look_for_signals() {
  const nb::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() == 0) return;
  cancelled_ = true;
  if (PyErr_ExceptionMatches(PyExc_KeyboardInterrupt)) {
    PyErr_Clear();
  } else {
    throw nb::python_error();  // of a handler of the caller's
  }
}

void Job::run(const std::function<void(const RunControl&)>& work) {
  const RunControl wanted = control();
  std::exception_ptr failed;
  {
    const nb::gil_scoped_release released;
    Beside beside([&] { work(wanted); });
    while (!beside.wait_for(kLook)) {
      try {
        look_for_signals();
      } catch (...) {
        failed = std::current_exception();
      }
    }
    if (!failed) failed = beside.error();
  }
  if (failed) std::rethrow_exception(failed);
}

}  // namespace impactdic::python
