#include "host/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>

namespace impactdic {
namespace {

// oneTBB orders the pieces behind what was done before and before what comes after, by locks in its
// library that ThreadSanitizer does not see. There, and only there, the order is said once more.
#ifdef __SANITIZE_THREAD__
std::atomic<unsigned> order_seen = 0;
void say_what_was_done() { order_seen.fetch_add(1, std::memory_order_release); }
void see_what_was_done() { order_seen.load(std::memory_order_acquire); }
#else
void say_what_was_done() {}
void see_what_was_done() {}
#endif

}  // namespace

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work) {
  std::mutex mutex;
  std::exception_ptr error;
  std::size_t error_index = count;
  const auto run = [&](std::size_t i) {
    try {
      work(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (i < error_index) error_index = i, error = std::current_exception();
    }
  };
  say_what_was_done();
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          see_what_was_done();
          for (std::size_t i = range.begin(); i < range.end(); ++i) run(i);
          say_what_was_done();
        },
        tbb::simple_partitioner());
  });
  see_what_was_done();
  if (error) std::rethrow_exception(error);
}

std::vector<char> parallel_pieces(std::size_t count, int threads, const char* phase,
                                  const RunControl& control,
                                  const std::function<void(std::size_t)>& work) {
  std::vector<char> done(count, 0);
  std::mutex mutex;  // the callbacks are called from one thread at a time
  std::int64_t finished = 0;
  parallel_for(count, threads, [&](std::size_t i) {
    {
      const std::lock_guard lock(mutex);
      if (control.is_cancelled()) return;
    }
    work(i);
    const std::lock_guard lock(mutex);
    done[i] = 1;
    if (control.progress) {
      control.progress({phase, ++finished, static_cast<std::int64_t>(count)});
    }
  });
  return done;
}

}  // namespace impactdic
