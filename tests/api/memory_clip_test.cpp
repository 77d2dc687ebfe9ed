// Clips from the caller's memory: what is borrowed, what is copied, what is refused.
#include <gtest/gtest.h>
#include <impactdic/clip.h>
#include <impactdic/error.h>

#include <cstring>

namespace impactdic {
namespace {

MemoryClip clip_of(std::vector<const void*> frames, int width, int height, int bits,
                   std::ptrdiff_t pitch_bytes = 0) {
  MemoryClip clip;
  clip.width = width;
  clip.height = height;
  clip.bits = bits;
  clip.frames = std::move(frames);
  clip.pitch_bytes = pitch_bytes;
  return clip;
}

TEST(MemoryClip, RowsWithoutGapsAreShownWhereTheyLie) {
  const std::vector<std::uint8_t> bytes = {1, 2, 3, 4, 5, 6};
  const std::vector<std::uint16_t> words = {1000, 2000, 3000, 4000, 4094, 4095};
  Frame frame;
  clip_from_memory(clip_of({bytes.data()}, 3, 2, 8))->read(0, frame);
  EXPECT_EQ(frame.bytes(), bytes.data());
  EXPECT_EQ(frame.width(), 3);
  const auto deep = clip_from_memory(clip_of({words.data()}, 3, 2, 12));
  deep->read(0, frame);
  EXPECT_EQ(frame.bytes(), words.data());
  EXPECT_EQ(frame.bits, 12);
  EXPECT_EQ(std::as_const(frame.u16)(2, 1), 4095);
  EXPECT_EQ(deep->info().frame_count, 1);
  EXPECT_FALSE(deep->info().fps);
}

TEST(MemoryClip, AnyPitchGivesTheSamePixels) {
  // Rows of three 16-bit pixels 7 bytes apart, from an odd address; and upside down.
  const std::uint16_t pixels[2][3] = {{1, 2, 3}, {65535, 5, 6}};
  std::vector<std::uint8_t> memory(32, 0xee);
  std::uint8_t* const first =
      memory.data() + (reinterpret_cast<std::uintptr_t>(memory.data()) % 2 == 0 ? 1 : 0);
  for (int y = 0; y < 2; ++y) std::memcpy(first + 7 * y, pixels[y], 6);
  Frame frame;
  clip_from_memory(clip_of({first}, 3, 2, 16, 7))->read(0, frame);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) EXPECT_EQ(std::as_const(frame.u16)(x, y), pixels[y][x]);
  }
  clip_from_memory(clip_of({first + 7}, 3, 2, 16, -7))->read(0, frame);
  EXPECT_EQ(std::as_const(frame.u16)(0, 0), 65535);
  EXPECT_EQ(std::as_const(frame.u16)(2, 1), 3);
}

TEST(MemoryClip, TheOwnerLivesAsLongAsAFrameIsUsed) {
  auto owner = std::make_shared<std::vector<std::uint8_t>>(6, 7);
  const std::weak_ptr<std::vector<std::uint8_t>> watched = owner;
  Frame frame;
  {
    MemoryClip clip = clip_of({owner->data()}, 3, 2, 8);
    clip.owner = std::move(owner);
    clip_from_memory(std::move(clip))->read(0, frame);
  }
  EXPECT_FALSE(watched.expired());
  EXPECT_EQ(std::as_const(frame.u8)(2, 1), 7);
  frame.reset(1, 1, 8);
  EXPECT_TRUE(watched.expired());
}

TEST(MemoryClip, TheImpossibleIsRefused) {
  const std::vector<std::uint16_t> words(6, 0x1000);
  const void* const at = words.data();
  EXPECT_THROW(clip_from_memory(clip_of({at}, 0, 2, 8)), InvalidArgument);
  EXPECT_THROW(clip_from_memory(clip_of({at}, 3, 2, 0)), InvalidArgument);
  EXPECT_THROW(clip_from_memory(clip_of({at}, 3, 2, 17)), InvalidArgument);
  EXPECT_THROW(clip_from_memory(clip_of({at}, 3, 2, 16, 5)), InvalidArgument);
  EXPECT_THROW(clip_from_memory(clip_of({at, nullptr}, 3, 2, 16)), InvalidArgument);
  EXPECT_THROW(clip_from_memory(clip_of({}, 3, 2, 16)), InvalidArgument);
  Frame frame;
  const auto clip = clip_from_memory(clip_of({at}, 3, 2, 12));
  EXPECT_THROW(clip->read(0, frame), InvalidArgument);  // 0x1000 has 13 bits
  EXPECT_THROW(clip->read(1, frame), InvalidArgument);
}

TEST(CallbackClip, GivesWhatTheFunctionMakesAndChecksIt) {
  ClipInfo info;
  info.width = 4;
  info.height = 2;
  info.bits = 10;
  info.frame_count = 3;
  const auto clip = clip_from_callback(info, [](std::int64_t index, Frame& frame) {
    frame.reset(index == 2 ? 5 : 4, 2, 10);
    std::fill_n(frame.u16.data(), frame.u16.size(), static_cast<std::uint16_t>(index));
  });
  Frame frame;
  clip->read(1, frame);
  EXPECT_EQ(frame.u16(3, 1), 1);
  EXPECT_THROW(clip->read(2, frame), InvalidArgument);  // another size
  EXPECT_THROW(clip->read(3, frame), InvalidArgument);
  info.frame_count = 0;
  EXPECT_THROW(clip_from_callback(info, [](std::int64_t, Frame&) {}), InvalidArgument);
  info.frame_count = 1;
  EXPECT_THROW(clip_from_callback(info, {}), InvalidArgument);
}

}  // namespace
}  // namespace impactdic
