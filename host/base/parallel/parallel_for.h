// Independent pieces of work on several threads, with oneTBB as everywhere (pipeline.h: items that
// go through stages). Only work that waits has a thread of its own (std::thread, std::async): for a
// device, for the disk, for a socket or a child process, for the clock, or for a whole run with its
// loops. A thread of oneTBB that waited so would be missing elsewhere.
#pragma once

#include <impactdic/control.h>

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace impactdic {

// Calls work(0) ... work(count - 1), `threads` at a time (0: as many as oneTBB has). Every piece is
// begun whatever another one throws; then the exception of the lowest index is thrown again here,
// so that errors do not depend on timing.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

// The same on the threads that serve the caller, who may be at a piece of other work; neighbouring
// indices may be done one after the other by one thread. A caller who holds a lock or has others
// wait for it calls it within tbb::this_task_arena::isolate: otherwise its thread may take up other
// work while it waits for the last pieces.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work);

// Calls work(), which so many of oneTBB's threads serve, the caller's among them; what it throws is
// thrown again here.
void on_threads(int threads, const std::function<void()>& work);

// The first of parallel_for, followed and stopped by `control`, whose progress names `phase`.
// Returns for each piece whether it was done: those not begun when the caller cancels are left out.
std::vector<char> parallel_pieces(std::size_t count, int threads, const char* phase,
                                  const RunControl& control,
                                  const std::function<void(std::size_t)>& work);

// Keeps the results of the pieces that were done, in their order. Returns whether any is missing.
template <typename Result>
bool keep_done(const std::vector<char>& done, std::vector<Result>& results) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < done.size(); ++i) {
    if (!done[i]) continue;
    if (kept != i) results[kept] = std::move(results[i]);
    ++kept;
  }
  results.resize(kept);
  return kept < done.size();
}

}  // namespace impactdic
