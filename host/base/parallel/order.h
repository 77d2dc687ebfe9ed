// Order between threads, said to ThreadSanitizer. oneTBB orders pieces of work by locks in its own
// library, which is not instrumented: ThreadSanitizer does not see them. Whoever hands work to
// oneTBB (parallel_for.h, pipeline.h) says the order that oneTBB keeps; without ThreadSanitizer
// these are nothing.
#pragma once

#include <utility>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace impactdic::order {

// What this thread did so far comes before what a thread does after `follow` with the same address.
inline void pass_on([[maybe_unused]] const void* address) {
#ifdef __SANITIZE_THREAD__
  __tsan_release(const_cast<void*>(address));
#endif
}

inline void follow([[maybe_unused]] const void* address) {
#ifdef __SANITIZE_THREAD__
  __tsan_acquire(const_cast<void*>(address));
#endif
}

// A function that oneTBB copies and calls on other threads: who calls a copy follows who made it.
template <typename Function>
class Handed {
 public:
  explicit Handed(Function function) : function_(std::move(function)) {}
  Handed(const Handed& other) : function_(other.function_) { pass_on(this); }
  Handed& operator=(const Handed&) = delete;
  ~Handed() = default;

  template <typename Argument>
  decltype(auto) operator()(Argument&& argument) const {
    follow(this);
    return function_(std::forward<Argument>(argument));
  }

 private:
  Function function_;
};

}  // namespace impactdic::order
