// Work that members share: on a file system in memory, with a clock of the test's own.
#include "host/cluster/work_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <queue>
#include <random>
#include <thread>

#include "tests/support/scratch.h"
#include "tests/unit/cluster/memory_files.h"

namespace impactdic::cluster {
namespace {

using impactdic::testing::MemoryFiles;
using impactdic::testing::ScratchFolder;

constexpr double kLostAfter_s = 60;

std::vector<std::string> pieces(std::size_t count) {
  std::vector<std::string> made;
  for (std::size_t i = 0; i < count; ++i) made.push_back("piece " + std::to_string(i));
  return made;
}

class Share {
 public:
  explicit Share(Files& files, std::size_t work, int shards = 0)
      : files_(files), work_(work), shards_(shards) {}
  std::unique_ptr<WorkQueue> member(const std::string& name, int shard = -1) {
    QueueOptions options;
    options.name = "share";
    options.member = name;
    options.described = "host elsewhere\npid 12\nstart 34\nname rank of " + name + "\n";
    options.shards = shards_;
    if (shard >= 0) options.shard = shard;
    options.lost_after_s = kLostAfter_s;
    auto queue = std::make_unique<WorkQueue>(
        files_, options, [this] { return now_s; },
        [this](const std::string& beat) { return !gone.empty() && beat.find(gone) != beat.npos; });
    while (!queue->open("settings", [&] { return pieces(work_); })) {
    }
    return queue;
  }
  double now_s = 0;
  std::string gone;  // whose process ends, by a word of its beat

 private:
  Files& files_;
  std::size_t work_;
  int shards_;
};

// As a member that has found nothing to take.
Outlook look(WorkQueue& queue) {
  EXPECT_FALSE(queue.take());
  return queue.look();
}

TEST(WorkQueue, EveryPieceIsTakenOnceByOneMember) {
  MemoryFiles files;
  Share share(files, 100);
  const auto a = share.member("a"), b = share.member("b");
  std::map<std::size_t, int> times;
  for (int i = 0; i < 50; ++i) {
    for (WorkQueue* queue : {a.get(), b.get()}) {
      const auto ticket = queue->take();
      ASSERT_TRUE(ticket);
      EXPECT_EQ(ticket->text, "piece " + std::to_string(ticket->index));
      ++times[ticket->index];
      EXPECT_TRUE(queue->finish(*ticket));
    }
  }
  EXPECT_EQ(times.size(), 100u);
  EXPECT_FALSE(a->take());
  EXPECT_EQ(look(*a), Outlook::kOver);
  EXPECT_EQ(a->take_closing(), Closing::kMine);
  EXPECT_EQ(b->take_closing(), Closing::kWait);
  a->close();
  EXPECT_EQ(b->take_closing(), Closing::kDone);
}

TEST(WorkQueue, OtherSettingsAreRefused) {
  MemoryFiles files;
  Share share(files, 3);
  share.member("a");
  WorkQueue other(files, {.name = "share", .member = "b"}, [] { return 0.0; }, {});
  EXPECT_THROW(other.open("other settings", [] { return pieces(3); }), InvalidArgument);
}

TEST(WorkQueue, WhatCannotBeMadeLeavesNothing) {
  MemoryFiles files;
  WorkQueue queue(files, {.name = "share", .member = "a"}, [] { return 0.0; }, {});
  const auto refuse = []() -> std::vector<std::string> { throw InvalidArgument("no clips"); };
  EXPECT_THROW(queue.open("settings", refuse), InvalidArgument);
  EXPECT_TRUE(files.files().empty());
  EXPECT_FALSE(files.exists("share.making"));
}

// A beat that stays the same for the stated time, whatever the clocks of the machines say.
TEST(WorkQueue, ASilentMembersPiecesGoToOthers) {
  MemoryFiles files;
  Share share(files, 2);
  const auto dead = share.member("dead"), alive = share.member("alive");
  const auto lost = dead->take();
  const auto mine = alive->take();
  ASSERT_TRUE(lost && mine);
  alive->finish(*mine);
  EXPECT_EQ(look(*alive), Outlook::kWait);
  share.now_s = kLostAfter_s - 1;
  dead->beat();
  EXPECT_EQ(look(*alive), Outlook::kWait);
  share.now_s += kLostAfter_s - 1;
  EXPECT_EQ(look(*alive), Outlook::kWait);
  EXPECT_TRUE(dead->holds(*lost));
  share.now_s += 1;
  EXPECT_EQ(look(*alive), Outlook::kWork);
  EXPECT_EQ(alive->newly_lost(),
            std::vector<std::string>{"process 12 on elsewhere (rank of dead)"});
  const auto again = alive->take();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->index, lost->index);
  EXPECT_EQ(again->attempt, 1);
  // It was only slow: it sees that its piece is another's.
  EXPECT_FALSE(dead->holds(*lost));
  EXPECT_FALSE(dead->finish(*lost));
  EXPECT_TRUE(alive->finish(*again));
  EXPECT_EQ(look(*alive), Outlook::kOver);
  EXPECT_EQ(alive->lost().size(), 1u);
}

TEST(WorkQueue, AProcessThatHasEndedIsGivenUpAtOnce) {
  MemoryFiles files;
  Share share(files, 1);
  const auto dead = share.member("dead"), alive = share.member("alive");
  ASSERT_TRUE(dead->take());
  EXPECT_EQ(look(*alive), Outlook::kWait);
  share.gone = "rank of dead";
  EXPECT_EQ(look(*alive), Outlook::kWork);
  EXPECT_TRUE(alive->take());
}

TEST(WorkQueue, APieceThatEndsEveryMemberIsNotTriedForEver) {
  MemoryFiles files;
  Share share(files, 1);
  const auto watcher = share.member("watcher");
  for (int i = 0; i < WorkQueue::kMostAttempts; ++i) {
    const std::string name = "victim" + std::to_string(i);
    const auto victim = share.member(name);
    const auto ticket = victim->take();
    ASSERT_TRUE(ticket);
    EXPECT_FALSE(ticket->hopeless);
    share.gone = "rank of " + name;
    EXPECT_EQ(look(*watcher), Outlook::kWork);
  }
  const auto ticket = watcher->take();
  ASSERT_TRUE(ticket);
  EXPECT_TRUE(ticket->hopeless);
  EXPECT_EQ(ticket->text, "piece 0");
  EXPECT_TRUE(watcher->finish(*ticket));
  EXPECT_EQ(look(*watcher), Outlook::kOver);
}

// An editor's copy, a file system's own, a name that no count can hold.
TEST(WorkQueue, WhatIsNoTicketIsLeftAloneAndKeepsNobody) {
  MemoryFiles files;
  Share share(files, 2);
  const auto a = share.member("a");
  const std::vector<std::string> strange = {
      "share/todo/0/000001.0~", "share/todo/0/.nfs0001", "share/todo/0/-1.0",
      "share/taken/000001.2147483647.0.b", "share/taken/000001.-1.0.b"};
  for (const std::string& path : strange) files.write(path, "strange");
  for (int i = 0; i < 2; ++i) {
    const auto ticket = a->take();
    ASSERT_TRUE(ticket);
    EXPECT_TRUE(a->finish(*ticket));
  }
  EXPECT_EQ(look(*a), Outlook::kOver);
  for (const std::string& path : strange) EXPECT_TRUE(files.exists(path)) << path;
  EXPECT_EQ(a->take_closing(), Closing::kMine);
}

// It could not be put back, or a rename was done that was said to have failed.
TEST(WorkQueue, WhatLiesUnderAMembersOwnNameIsDone) {
  MemoryFiles files;
  Share share(files, 2);
  const auto a = share.member("a");
  const auto held = a->take(), forgotten = a->take();
  ASSERT_TRUE(held && forgotten);
  const auto again = share.member("a");  // knows of neither
  EXPECT_EQ(look(*a), Outlook::kWait);   // what it works at stays its own
  EXPECT_TRUE(a->finish(*held));
  EXPECT_EQ(look(*again), Outlook::kWork);
  const auto ticket = again->take();
  ASSERT_TRUE(ticket);
  EXPECT_EQ(ticket->index, forgotten->index);
  EXPECT_TRUE(again->finish(*ticket));
  EXPECT_EQ(look(*again), Outlook::kOver);
  // Nobody can do it: it is given up after some attempts.
  files.write("share/taken/000001.2.0.a", "piece 1");
  EXPECT_EQ(again->look(), Outlook::kWork);
  const auto last = again->take();
  ASSERT_TRUE(last && last->hopeless);
  EXPECT_TRUE(again->finish(*last));
  EXPECT_EQ(look(*again), Outlook::kOver);
}

TEST(WorkQueue, WhoeverEndsInTheLastStepIsFollowedByAnother) {
  MemoryFiles files;
  Share share(files, 1);
  const auto dead = share.member("dead"), alive = share.member("alive");
  dead->finish(*dead->take());
  EXPECT_EQ(dead->take_closing(), Closing::kMine);
  EXPECT_EQ(look(*alive), Outlook::kOver);
  EXPECT_EQ(alive->take_closing(), Closing::kWait);
  share.gone = "rank of dead";
  EXPECT_EQ(alive->take_closing(), Closing::kMine);
}

TEST(WorkQueue, AMakerThatEndsIsFollowedByAnother) {
  MemoryFiles files;
  files.make_folder("share.making");
  files.write("share.making/maker", "host elsewhere\npid 1\nbeat 1\n");
  double now_s = 0;
  WorkQueue queue(files, {.name = "share", .member = "a"}, [&] { return now_s; }, {});
  const auto make = [] { return pieces(2); };
  EXPECT_FALSE(queue.open("settings", make));
  now_s = kLostAfter_s - 1;
  EXPECT_FALSE(queue.open("settings", make));
  EXPECT_FALSE(files.exists("share"));
  now_s = kLostAfter_s;
  for (int i = 0; i < 3; ++i) queue.open("settings", make);
  EXPECT_TRUE(queue.take());
}

TEST(WorkQueue, ShardsTakeTheirOwnAndTheLastOneCloses) {
  MemoryFiles files;
  Share share(files, 10, 3);
  for (int shard = 0; shard < 3; ++shard) {
    const auto queue = share.member("m" + std::to_string(shard), shard);
    std::size_t count = 0;
    while (const auto ticket = queue->take()) {
      EXPECT_EQ(ticket->index % 3, static_cast<std::size_t>(shard));
      queue->finish(*ticket);
      ++count;
    }
    EXPECT_EQ(count, shard == 0 ? 4u : 3u);
    EXPECT_EQ(queue->look(), shard < 2 ? Outlook::kElsewhere : Outlook::kOver);
  }
}

TEST(WorkQueue, ThreadsOnADiskTakeEachPieceOnce) {
  const ScratchFolder folder;
  DiskFiles files(folder / "shared");
  constexpr std::size_t kPieces = 200, kMembers = 8;
  Share share(files, kPieces);
  std::vector<std::vector<std::size_t>> taken(kMembers);
  {
    std::vector<std::jthread> threads;
    for (std::size_t k = 0; k < kMembers; ++k) {
      threads.emplace_back([&, k] {
        const auto queue = share.member("m" + std::to_string(k));
        while (const auto ticket = queue->take()) {
          taken[k].push_back(ticket->index);
          EXPECT_TRUE(queue->finish(*ticket));
        }
      });
    }
  }
  std::vector<std::size_t> all;
  for (const auto& some : taken) all.insert(all.end(), some.begin(), some.end());
  std::sort(all.begin(), all.end());
  ASSERT_EQ(all.size(), kPieces);
  for (std::size_t i = 0; i < kPieces; ++i) EXPECT_EQ(all[i], i);
}

// Many members, each with pieces that take it different times: what they ask of the file system.
struct Cost {
  double per_piece = 0;   // operations
  std::size_t twice = 0;  // pieces that were finished other than once
};

Cost simulate(std::size_t members, std::size_t pieces_each, std::size_t killed) {
  constexpr double kPiece_s = 20, kNap_s = 2;
  MemoryFiles files;
  const std::size_t count = members * pieces_each;
  Share share(files, count);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> factor(0.2, 2);
  struct Event {
    double at_s;
    std::size_t member;
    bool operator>(const Event& other) const { return at_s > other.at_s; }
  };
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events;
  std::vector<std::unique_ptr<WorkQueue>> queues;
  std::vector<std::optional<Ticket>> holds(members);
  std::vector<double> beaten(members, 0);
  for (std::size_t k = 0; k < members; ++k) {
    queues.push_back(share.member("m" + std::to_string(k)));
    events.push({0, k});
  }
  std::vector<int> finished(count, 0);
  for (; !events.empty(); events.pop()) {
    const auto [at_s, k] = events.top();
    share.now_s = at_s;
    if (k < killed && at_s > 30) continue;  // it never comes again
    for (; beaten[k] + kLostAfter_s / 6 < at_s; beaten[k] += kLostAfter_s / 6) queues[k]->beat();
    if (holds[k]) {
      finished[holds[k]->index] += queues[k]->finish(*holds[k]);
      holds[k].reset();
    }
    if ((holds[k] = queues[k]->take())) {
      events.push({at_s + kPiece_s * factor(random), k});
    } else if (queues[k]->look() != Outlook::kOver) {
      events.push({at_s + kNap_s, k});
    }
  }
  Cost cost;
  cost.per_piece = static_cast<double>(files.operations) / static_cast<double>(count);
  for (const int times : finished) cost.twice += times != 1;
  return cost;
}

// Weak scaling: with as many pieces a member, a member costs the same among 256 as alone. What grew
// with members times pieces would be 256 times as much.
TEST(WorkQueue, ManyMembersAskNoMoreOfTheFileSystemEach) {
  const Cost one = simulate(1, 40, 0);
  for (const std::size_t members : {16u, 256u}) {
    const Cost many = simulate(members, 40, 0);
    std::printf("%zu members: %.2f operations a piece, alone %.2f\n", members, many.per_piece,
                one.per_piece);
    EXPECT_EQ(many.twice, 0u);
    EXPECT_LT(many.per_piece, 2 * one.per_piece) << members;
  }
  // Those that end with pieces in hand lose none of them.
  const Cost reduced = simulate(256, 40, 16);
  EXPECT_EQ(reduced.twice, 0u);
  EXPECT_LT(reduced.per_piece, 2.5 * one.per_piece);
}

}  // namespace
}  // namespace impactdic::cluster
