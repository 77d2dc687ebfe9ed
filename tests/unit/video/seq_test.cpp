// Norpix .seq: files are put together here byte by byte, from the layout alone.
#include <gtest/gtest.h>
#include <impactdic/clip.h>
#include <impactdic/error.h>

#include <bit>
#include <fstream>
#include <functional>

#include "host/video/frame_source.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

constexpr int kWidth = 6, kHeight = 4, kFrames = 3;

struct Layout {
  std::int32_t version = 5;
  std::uint32_t stored_bits = 8, real_bits = 8;
  std::uint32_t format = 100, compression = 0, frames = kFrames;
  int gap = 500;  // bytes between a frame's time and the next frame
  std::function<std::int64_t(int frame)> time_us = [](int k) { return 1000250 + 125 * k; };
};

void put(std::string& file, std::size_t at, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) file[at + i] = static_cast<char>(value >> 8 * i & 0xff);
}

int pixel(int frame, int index, std::uint32_t bits) {
  return (index * 7 + frame * 31 + 300) % (1 << bits);
}

std::string made(const Layout& layout) {
  const std::size_t image = kWidth * kHeight * layout.stored_bits / 8;
  const std::size_t first = layout.version >= 5 ? 8192 : 1024, time = layout.version >= 5 ? 8 : 6;
  const std::size_t step = image + time + layout.gap;
  std::string file(first + kFrames * step, '\0');
  put(file, 0, 0xfeed, 4);
  const std::string name = "Norpix seq";
  for (std::size_t i = 0; i < name.size(); ++i) file[4 + 2 * i] = name[i];
  put(file, 28, layout.version, 4);
  put(file, 32, 1024, 4);
  put(file, 548, kWidth, 4);
  put(file, 552, kHeight, 4);
  put(file, 556, layout.stored_bits, 4);
  put(file, 560, layout.real_bits, 4);
  put(file, 564, image, 4);
  put(file, 568, layout.format, 4);
  put(file, 572, layout.frames, 4);
  put(file, 580, step, 4);
  put(file, 584, std::bit_cast<std::uint64_t>(8000.0), 8);
  put(file, 620, layout.compression, 4);
  for (int k = 0; k < kFrames; ++k) {
    const std::size_t at = first + k * step;
    for (int i = 0; i < kWidth * kHeight; ++i) {
      const int bytes = static_cast<int>(layout.stored_bits / 8);
      put(file, at + i * bytes, pixel(k, i, layout.real_bits), bytes);
    }
    const std::int64_t us = layout.time_us(k);
    put(file, at + image, us / 1000000, 4);
    put(file, at + image + 4, us / 1000 % 1000, 2);
    if (time == 8) put(file, at + image + 6, us % 1000, 2);
  }
  return file;
}

class Seq : public ::testing::Test {
 protected:
  std::unique_ptr<FrameSource> open(const std::string& bytes) {
    const std::string path = folder_.file("clip.seq");
    std::ofstream(path, std::ios::binary) << bytes;
    return video::open_video({path}, {});
  }
  testing::ScratchFolder folder_;
};

TEST_F(Seq, FramesOfEveryLayout) {
  for (const std::int32_t version : {3, 5}) {
    for (const auto& [stored, real] : {std::pair(8u, 8u), {16u, 10u}, {16u, 12u}, {16u, 16u}}) {
      Layout layout;
      layout.version = version;
      layout.stored_bits = stored;
      layout.real_bits = real;
      layout.time_us = [](int k) { return 5000000 + 2000 * k; };
      const auto clip = open(made(layout));
      EXPECT_EQ(clip->info().format, "Norpix seq");
      EXPECT_EQ(clip->info().bits, static_cast<int>(real));
      EXPECT_EQ(clip->info().fps, 8000);
      ASSERT_EQ(clip->info().frame_count, kFrames);
      Frame frame;
      for (int k = kFrames - 1; k >= 0; --k) {
        clip->read(k, frame);
        ASSERT_EQ(frame.width(), kWidth);
        ASSERT_EQ(frame.height(), kHeight);
        for (int i = 0; i < kWidth * kHeight; ++i) {
          const int value = real > 8 ? frame.u16.data()[i] : frame.u8.data()[i];
          ASSERT_EQ(value, pixel(k, i, real)) << version << " " << real << " " << k << " " << i;
        }
        EXPECT_NEAR(clip->frame_time_s(k).value(), 0.002 * k, 1e-12);
      }
    }
  }
}

TEST_F(Seq, TimesToTheMicrosecond) {
  const auto clip = open(made({}));
  EXPECT_TRUE(clip->info().has_timestamps);
  EXPECT_NEAR(clip->frame_time_s(2).value(), 250e-6, 1e-12);
}

TEST_F(Seq, TimesThatDoNotGrowAreNotUsed) {
  Layout layout;
  layout.time_us = [](int k) { return k == 2 ? 100 : 1000 + k; };
  const auto clip = open(made(layout));
  EXPECT_FALSE(clip->info().has_timestamps);
  EXPECT_FALSE(clip->frame_time_s(1).has_value());
  ASSERT_EQ(clip->info().warnings.size(), 1u);
  EXPECT_NE(clip->info().warnings[0].find("frame 2"), std::string::npos);
}

TEST_F(Seq, ARecordingThatWasNotClosedHasTheFramesThatAreThere) {
  Layout layout;
  layout.frames = 0;
  EXPECT_EQ(open(made(layout))->info().frame_count, kFrames);
}

TEST_F(Seq, WhatIsNotReadIsSaid) {
  Layout colour, packed, deep;
  colour.format = 200;
  packed.compression = 1;
  deep.stored_bits = 24;
  for (const Layout& layout : {colour, packed, deep}) {
    EXPECT_THROW(open(made(layout)), FormatError);
  }
}

TEST_F(Seq, DamageIsAnErrorWhereverTheFileEnds) {
  const std::string whole = made({});
  for (const std::size_t length : {30u, 600u, 1023u, 8191u, 8200u, 8192u + 600u}) {
    EXPECT_THROW(open(whole.substr(0, length)), FormatError) << length;
  }
  std::string wrong = whole;
  put(wrong, 564, 23, 4);  // the size of a picture
  EXPECT_THROW(open(wrong), FormatError);
  wrong = whole;
  put(wrong, 580, 10, 4);  // frames closer than they are long
  EXPECT_THROW(open(wrong), FormatError);
  wrong = whole;
  put(wrong, 548, 0xffffffff, 4);
  EXPECT_THROW(open(wrong), FormatError);
}

}  // namespace
}  // namespace impactdic
