// Runs the library's work beside the interpreter: other Python threads go on, Ctrl-C is noticed.
#pragma once

#include <impactdic/control.h>
#include <nanobind/nanobind.h>

#include <atomic>
#include <functional>

namespace impactdic::python {

// What a caller wants to hear of a run; either may be None.
//   progress(phase: str, done: int, total: int)
//   message(kind: str, text: str)      kind: note, warning, timing
struct Listeners {
  nanobind::object progress, message;
};

// One run. Made, run and destroyed in the thread of Python that asked for it, which holds the GIL.
class Job {
 public:
  explicit Job(Listeners listeners) : listeners_(std::move(listeners)) {}
  // Calls `work` in a thread of its own, without the GIL, and waits for it. Ctrl-C makes
  // `cancelled` true: the work then ends by itself with what it has. Rethrows what `work` throws.
  void run(const std::function<void(const RunControl&)>& work);
  // Whether Ctrl-C was pressed meanwhile.
  bool interrupted() const { return cancelled_; }

 private:
  RunControl control();
  void look_for_signals();

  Listeners listeners_;
  std::atomic<bool> cancelled_ = false;
};

}  // namespace impactdic::python
