#include "host/base/parallel/parallel_for.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <cstdint>
#include <exception>
#include <mutex>

#include "host/base/parallel/order.h"

namespace impactdic {
namespace {

// The pieces of one loop: behind what its caller did before, ahead of what it does afterwards. Of
// each other they know nothing.
class Pieces {
 public:
  explicit Pieces(const std::function<void(std::size_t)>& work) : work_(work) {
    order::pass_on(&begun_);
  }

  void operator()(const tbb::blocked_range<std::size_t>& range) {
    order::follow(&begun_);
    for (std::size_t i = range.begin(); i < range.end(); ++i) run(i);
    order::pass_on(&ended_);
  }

  // Once all are done.
  void end() {
    order::follow(&ended_);
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void run(std::size_t i) {
    try {
      work_(i);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_ || i < error_index_) error_index_ = i, error_ = std::current_exception();
    }
  }

  const std::function<void(std::size_t)>& work_;
  std::mutex mutex_;
  std::exception_ptr error_;
  std::size_t error_index_ = 0;
  char begun_ = 0, ended_ = 0;  // their addresses stand for the order
};

}  // namespace

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work) {
  Pieces pieces(work);
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        order::Handed([&](const tbb::blocked_range<std::size_t>& range) { pieces(range); }),
        tbb::simple_partitioner());
  });
  pieces.end();
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work) {
  Pieces pieces(work);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count),
      order::Handed([&](const tbb::blocked_range<std::size_t>& range) { pieces(range); }));
  pieces.end();
}

void on_threads(int threads, const std::function<void()>& work) {
  const char begun = 0, ended = 0;
  order::pass_on(&begun);
  tbb::task_arena(threads).execute([&] {
    order::follow(&begun);
    work();
    order::pass_on(&ended);
  });
  order::follow(&ended);
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
