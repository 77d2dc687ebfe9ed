// Order between threads, said to ThreadSanitizer. oneTBB orders pieces of work by locks in its own
// library, which is not instrumented: ThreadSanitizer does not see them. Whoever hands work to
// oneTBB (parallel_for.h, pipeline.h) says the order that oneTBB keeps; without ThreadSanitizer
// these are nothing.
#pragma once

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

}  // namespace impactdic::order
