#include "host/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <cstdint>
#include <exception>
#include <mutex>

namespace impactdic {

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
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i < range.end(); ++i) run(i);
        },
        tbb::simple_partitioner());
  });
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
