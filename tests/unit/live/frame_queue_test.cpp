// Frames between a camera that does not wait and whoever measures them.
#include "host/video/live/frame_queue.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <impactdic/live/track_live.h>

#include <fstream>
#include <thread>

#include "tests/support/scratch.h"

namespace impactdic::video {
namespace {

using impactdic::testing::ScratchFolder;
using std::chrono::duration;

constexpr duration<double> kForEver{0}, kNoPatience{0}, kPatience{10};

Frame frame_of(std::uint8_t grey) {
  Frame frame;
  frame.reset(1, 1, 8);
  frame.u8.data()[0] = grey;
  return frame;
}

std::vector<std::int64_t> numbers(const std::vector<ArrivedFrame>& frames) {
  std::vector<std::int64_t> found;
  for (const ArrivedFrame& frame : frames) found.push_back(frame.number);
  return found;
}

using Numbers = std::vector<std::int64_t>;

TEST(FrameQueue, TheOldestAreDroppedAndTheRestFollowEachOther) {
  FrameQueue queue(3, false);
  for (int i = 0; i < 5; ++i) queue.push(frame_of(static_cast<std::uint8_t>(i)));
  const auto frames = queue.pop(3, kForEver, kPatience);
  EXPECT_EQ(numbers(frames), (Numbers{2, 3, 4}));
  EXPECT_EQ(frames[0].frame.u8.data()[0], 2);
  EXPECT_EQ(queue.dropped(), 2);
}

TEST(FrameQueue, ABatchThatIsNotFullComesAfterItsWait) {
  FrameQueue queue(10, false);
  EXPECT_TRUE(queue.pop(2, duration<double>(0.001), kNoPatience).empty());
  queue.push(frame_of(0));
  EXPECT_TRUE(queue.pop(2, kForEver, kNoPatience).empty());
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(numbers(queue.pop(2, duration<double>(0.02), kPatience)), (Numbers{0}));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, kPatience);
}

TEST(FrameQueue, TheEndComesAfterTheLastFrameAndTheErrorAfterThat) {
  FrameQueue queue(10, false);
  queue.push(frame_of(0));
  queue.close(std::make_exception_ptr(FormatError("pipe", -1, "cut off")));
  EXPECT_FALSE(queue.is_over());
  EXPECT_EQ(queue.pop(4, kForEver, kPatience).size(), 1u);
  EXPECT_THROW(queue.pop(4, kForEver, kPatience), FormatError);
  EXPECT_TRUE(queue.is_over());
  EXPECT_TRUE(queue.pop(4, kForEver, kPatience).empty());
}

TEST(FrameQueue, WhereNothingMayBeDroppedTheSenderWaits) {
  FrameQueue queue(4, true);
  std::jthread sender([&] {
    for (int i = 0; i < 100; ++i) queue.push(frame_of(0));
    queue.close();
  });
  Numbers all;
  for (;;) {
    const auto frames = queue.pop(3, kForEver, kPatience);
    if (frames.empty()) break;
    for (const auto& frame : frames) all.push_back(frame.number);
  }
  ASSERT_EQ(all.size(), 100u);
  for (std::int64_t i = 0; i < 100; ++i) EXPECT_EQ(all[static_cast<std::size_t>(i)], i);
  EXPECT_EQ(queue.dropped(), 0);
}

TEST(FrameQueue, ASenderThatWaitsIsLetGo) {
  FrameQueue queue(1, true);
  std::jthread sender([&] {
    for (int i = 0; i < 3; ++i) queue.push(frame_of(0));
  });
  queue.abandon();
}

TEST(RawStream, GivesFramesAndSaysWhereOneIsCut) {
  const ScratchFolder folder;
  std::ofstream(folder / "whole", std::ios::binary) << std::string("abcdefgh");
  std::ofstream(folder / "cut", std::ios::binary) << std::string("abcdefg");
  const auto whole = open_raw_stream(folder.file("whole"), {2, 2, 8});
  EXPECT_EQ(whole->info().width, 2);
  Frame frame;
  ASSERT_TRUE(whole->next(frame));
  EXPECT_EQ(frame.u8.row(1)[0], 'c');
  ASSERT_TRUE(whole->next(frame));
  EXPECT_EQ(frame.u8.row(0)[0], 'e');
  EXPECT_FALSE(whole->next(frame));
  const auto cut = open_raw_stream(folder.file("cut"), {2, 2, 8});
  ASSERT_TRUE(cut->next(frame));
  EXPECT_THROW(cut->next(frame), FormatError);
  EXPECT_THROW(open_raw_stream(folder.file("absent"), {2, 2, 8}), FileError);
  EXPECT_THROW(open_raw_stream(folder.file("whole"), {2, 2, 9}), InvalidArgument);
  const auto stopped = open_raw_stream(folder.file("whole"), {2, 2, 8});
  stopped->stop();
  EXPECT_FALSE(stopped->next(frame));
}

}  // namespace
}  // namespace impactdic::video
