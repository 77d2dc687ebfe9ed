// Independent pieces of work on several threads.
#include "host/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>

namespace impactdic {
namespace {

TEST(Parallel, EveryPieceIsDoneOnceWithAnyNumberOfThreads) {
  for (const int threads : {0, 1, 3}) {
    std::vector<std::atomic<int>> calls(200);
    parallel_for(calls.size(), threads, [&](std::size_t i) { ++calls[i]; });
    for (const auto& count : calls) EXPECT_EQ(count, 1) << threads;
  }
}

TEST(Parallel, NoMoreThreadsThanAskedFor) {
  std::atomic<int> now = 0, most = 0;
  parallel_for(24, 2, [&](std::size_t) {
    const int here = ++now;
    int seen = most;
    while (here > seen && !most.compare_exchange_weak(seen, here)) {
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    --now;
  });
  EXPECT_LE(most, 2);
}

// The first one by its index, whichever is thrown first; the other pieces are done all the same.
TEST(Parallel, ErrorIsTheLowestIndexs) {
  for (int round = 0; round < 20; ++round) {
    std::atomic<int> done = 0;
    try {
      parallel_for(40, 4, [&](std::size_t i) {
        if (i == 7) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (i % 10 == 7) throw std::runtime_error(std::to_string(i));
        ++done;
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "7");
    }
    EXPECT_EQ(done, 36);
  }
}

TEST(Parallel, CancelledPiecesAreLeftOutAndTheDoneOnesKept) {
  std::vector<int> results(10, -1);
  int told = 0;
  RunControl control;
  control.progress = [&](const Progress& p) {
    EXPECT_STREQ(p.phase, "pieces");
    EXPECT_EQ(p.total, 10);
    EXPECT_EQ(p.done, ++told);
  };
  control.cancelled = [&] { return told >= 4; };
  const std::vector<char> done = parallel_pieces(
      10, 1, "pieces", control, [&](std::size_t i) { results[i] = 10 * static_cast<int>(i); });
  EXPECT_TRUE(keep_done(done, results));
  EXPECT_EQ(told, 4);
  ASSERT_EQ(results.size(), 4u);
  for (const int result : results) EXPECT_EQ(result % 10, 0);
  std::vector<int> all{1, 2};
  EXPECT_FALSE(keep_done({1, 1}, all));
  EXPECT_EQ(all.size(), 2u);
}

}  // namespace
}  // namespace impactdic
