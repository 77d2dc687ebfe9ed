// Independent pieces of work on several threads.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "host/base/parallel/parallel_for.h"
#include "host/base/parallel/pipeline.h"
#include "host/base/process/stand_back.h"

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

TEST(Parallel, PiecesOnTheCallersThreadsAreDoneOnceAndTheLowestErrorIsThrown) {
  std::vector<int> calls(500, 0);  // not atomic: a piece is one thread's
  parallel_for(calls.size(), [&](std::size_t i) { ++calls[i]; });
  EXPECT_EQ(std::count(calls.begin(), calls.end(), 1), 500);
  try {
    parallel_for(40, [&](std::size_t i) {
      if (i % 10 == 7) throw std::runtime_error(std::to_string(i));
    });
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "7");
  }
}

TEST(Parallel, WhatWorkAsksForIsServedByNoMoreThreadsThanItIsGiven) {
  std::atomic<int> now = 0, most = 0;
  on_threads(1, [&] {
    parallel_for(24, [&](std::size_t) {
      const int here = ++now;
      int seen = most;
      while (here > seen && !most.compare_exchange_weak(seen, here)) {
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      --now;
    });
  });
  EXPECT_EQ(most, 1);
  EXPECT_THROW(on_threads(2, [] { throw std::runtime_error("work"); }), std::runtime_error);
}

// For good, and with it what it begins; not those beside it.
TEST(Parallel, AThreadThatStandsBackTakesItsOwnAlong) {
  const auto priority = [] { return ::getpriority(PRIO_PROCESS, 0); };
  const int before = priority();
  int own = 0, begun = 0;
  std::thread([&] {
    stand_back();
    own = priority();
    std::thread([&] { begun = priority(); }).join();
  }).join();
  EXPECT_EQ(own, std::min(before + 10, 19));  // the system knows none beyond 19
  EXPECT_EQ(begun, own);
  EXPECT_EQ(priority(), before);
}

// Plain numbers pass from stage to stage: under ThreadSanitizer this also tests that the order that
// oneTBB keeps is known to it.
TEST(Pipeline, ItemsComeInOrderAndNoMoreThanAskedForAreOnTheirWay) {
  using Item = std::shared_ptr<std::vector<int>>;
  int next = 0, sum = 0;
  std::atomic<int> begun = 0, ended = 0, most = 0;
  std::vector<int> seen;
  run_pipeline(
      3,
      [&] {
        if (next == 300) return Item();
        const int here = ++begun - ended;
        if (here > most) most = here;  // this stage alone counts
        return std::make_shared<std::vector<int>>(1, next++);
      },
      several_at_once([&](Item item) {
        item->push_back(2 * item->front());
        return item;
      }),
      in_order([&](const Item& item) {
        sum += item->back();
        return sum;
      }),
      several_at_once([&](int so_far) { return so_far / 2; }), in_order([&](int half) {
        seen.push_back(half);
        ++ended;
      }));
  ASSERT_EQ(seen.size(), 300u);
  for (int i = 0; i < 300; ++i) EXPECT_EQ(seen[static_cast<std::size_t>(i)], i * (i + 1) / 2);
  EXPECT_LE(most, 3);
}

TEST(Pipeline, AnErrorEndsItAndIsThrownAgain) {
  for (const int stage : {0, 1, 2}) {
    int next = 0, last = -1;
    const auto at = [&](int here, int item) {
      if (here == stage && item == 20) throw std::runtime_error("no");
    };
    EXPECT_THROW(run_pipeline(
                     4,
                     [&] {
                       at(0, next);
                       return next < 50 ? std::make_shared<int>(next++) : nullptr;
                     },
                     several_at_once([&](std::shared_ptr<int> item) {
                       at(1, *item);
                       return item;
                     }),
                     in_order([&](const std::shared_ptr<int>& item) {
                       at(2, *item);
                       last = *item;
                     })),
                 std::runtime_error)
        << stage;
    EXPECT_LT(last, 20) << stage;
    EXPECT_LE(next, 25) << stage;
  }
}

}  // namespace
}  // namespace impactdic
