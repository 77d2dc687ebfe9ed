// Damaged files: every one must end in one line of error or in whole frames, never in a crash,
// a hang or a huge allocation. Seeds are fixed.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <new>

#include "host/video/natural_order.h"
#include "tests/support/data.h"
#include "tests/support/video.h"

namespace {
std::size_t largest_allocation = 0;
}

// Counts what the readers ask for. (libtiff's own memory is limited by its open options.)
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (size > largest_allocation) largest_allocation = size;
  if (void* memory = std::malloc(size != 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace impactdic {
namespace {

using testing::data_path;
using testing::ScratchFolder;
using testing::write_bytes;

enum class Outcome { kRead, kRefused };

// Opens the clip and reads its first and last frames.
Outcome try_clip(const std::string& path, const OpenOptions& options = {}) {
  try {
    const auto clip = video::open_video({path}, options);
    const std::int64_t count = clip->info().frame_count;
    Frame frame;
    for (const std::int64_t k : {std::int64_t{0}, count - 1}) {
      clip->read(k, frame);
      clip->frame_time_s(k);
      clip->frame_exposure_s(k);
      EXPECT_EQ(frame.width(), clip->info().width);
      EXPECT_EQ(frame.height(), clip->info().height);
      EXPECT_EQ(frame.bits, clip->info().bits);
    }
    return Outcome::kRead;
  } catch (const Error& error) {
    EXPECT_FALSE(error.line().empty());
    EXPECT_EQ(error.line().find('\n'), std::string::npos) << error.line();
    const bool expected = dynamic_cast<const FileError*>(&error) != nullptr ||
                          dynamic_cast<const InvalidArgument*>(&error) != nullptr;
    EXPECT_TRUE(expected) << error.line();
    return Outcome::kRefused;
  }
}

// A clip to be damaged: `bytes` of the file `name`, beside which `others` must lie.
struct Victim {
  std::string name;
  std::vector<char> bytes;
  std::size_t header_bytes;  // where changes hit
  bool cut_is_fatal;         // every cut loses a frame
};

// Four frames of random pixels.
void write_clip(const std::string& path, video::SinkFormat format, int bits) {
  ClipInfo info;
  info.width = 48;
  info.height = 20;
  info.bits = bits;
  info.frame_count = 4;
  info.fps = 1000;
  info.exposure_s = 1e-4;
  const auto sink = video::open_sink(path, format, info);
  for (std::uint32_t k = 0; k < 4; ++k) {
    sink->write(testing::random_frame(info.width, info.height, bits, k));
  }
  sink->finish();
}

std::vector<Victim> victims(const ScratchFolder& folder) {
  std::vector<Victim> list;
  const auto make = [&](video::SinkFormat format, int bits, const char* tag, bool fatal) {
    const std::string name = std::string("made_") + tag + video::sink_extension(format);
    write_clip(folder.file(name), format, bits);
    auto bytes = testing::file_bytes(folder.file(name));
    const std::size_t header = std::min<std::size_t>(bytes.size(), 14500);
    list.push_back({name, std::move(bytes), header, fatal});
  };
  make(video::SinkFormat::kCine, 8, "8", true);
  make(video::SinkFormat::kCine, 12, "16", true);
  make(video::SinkFormat::kCinePacked10, 10, "10", true);
  make(video::SinkFormat::kCinePacked12, 12, "12", true);
  make(video::SinkFormat::kMraw, 8, "8", true);
  make(video::SinkFormat::kMrawPacked12, 12, "12", true);
  make(video::SinkFormat::kTiff, 8, "8", false);
  make(video::SinkFormat::kTiff, 16, "16", false);
  for (const char* name : {"made_8.cihx", "made_12.cihx"}) {
    auto bytes = testing::file_bytes(folder.file(name));
    const std::size_t size = bytes.size();
    list.push_back({name, std::move(bytes), size, false});
  }
  const auto real = [&](const std::string& path, bool fatal) {
    if (!std::filesystem::exists(data_path(path))) return;
    auto bytes = testing::file_bytes(data_path(path));
    const std::size_t header = std::min<std::size_t>(bytes.size(), 12500);
    const std::string name = std::filesystem::path(path).filename().string();
    write_bytes(folder.file(name), bytes);
    list.push_back({name, std::move(bytes), header, fatal});
  };
  for (const char* name : {"dice_packed_12bpp", "dice_phantom_v12_raw_16bpp", "dice_phantom_v1610",
                           "dice_phantom_v7_raw_16bpp", "dice_phantom_v9_raw_16bpp",
                           "hypercine_example_8bpp", "pyidi_data_small_cine"}) {
    real(std::string("cine/") + name + ".cine", true);
  }
  for (const char* name : {"ball_12bit.mraw", "beam.mraw", "data_showcase.mraw"}) {
    real(std::string("mraw/") + name, true);
  }
  for (const char* name : {"ball_12bit.cihx", "beam.cihx", "data_showcase.cih"}) {
    real(std::string("mraw/") + name, false);  // what follows the needed facts may be lost
  }
  real("cine/dice_invalid_color.cine", true);
  real("speckle/rotation_000.tif", false);
  real("speckle/rotation_170.tif", false);
  real("wheel/mechanism_4870.tif", false);
  return list;
}

class Damage : public ::testing::Test {
 protected:
  void SetUp() override { started_ = std::chrono::steady_clock::now(); }
  void TearDown() override {
    const auto spent = std::chrono::steady_clock::now() - started_;
    EXPECT_LT(std::chrono::duration<double>(spent).count(), 120);  // nothing hangs
    EXPECT_LT(largest_allocation, std::size_t{2} << 30);
  }
  ScratchFolder folder_;
  std::chrono::steady_clock::time_point started_;
};

TEST_F(Damage, CutAnywhere) {
  std::mt19937 random(20);
  for (const Victim& victim : victims(folder_)) {
    const std::string path = folder_.file(victim.name);
    std::vector<std::size_t> lengths(200);
    for (auto& length : lengths) length = random() % victim.bytes.size();
    std::sort(lengths.rbegin(), lengths.rend());
    for (const std::size_t length : lengths) {
      std::filesystem::resize_file(path, length);
      const Outcome outcome = try_clip(path);
      if (victim.cut_is_fatal) {
        ASSERT_EQ(outcome, Outcome::kRefused) << victim.name << " cut at " << length;
      }
    }
    write_bytes(path, victim.bytes);
  }
}

TEST_F(Damage, ChangedHeaderBytes) {
  std::mt19937 random(21);
  int read = 0, refused = 0;
  for (const Victim& victim : victims(folder_)) {
    const std::string path = folder_.file(victim.name);
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    const auto put = [&file](std::size_t at, char byte) {
      file.seekp(static_cast<std::streamoff>(at));
      file.write(&byte, 1);
    };
    for (int i = 0; i < 2000; ++i) {
      // One to four bytes, half of the time among the first 300, where most facts lie.
      const std::size_t range =
          i % 2 == 0 ? std::min<std::size_t>(300, victim.header_bytes) : victim.header_bytes;
      std::vector<std::size_t> places;
      for (unsigned n = 0; n <= random() % 4; ++n) {
        const std::size_t at = random() % range;
        places.push_back(at);
        const char extremes[] = {'\0', '\xff', '\x7f', '\x80'};
        put(at, random() % 3 == 0 ? extremes[random() % 4] : static_cast<char>(random()));
      }
      file.flush();
      (try_clip(path) == Outcome::kRead ? read : refused) += 1;
      for (const std::size_t at : places) put(at, victim.bytes[at]);
    }
    file.flush();
    EXPECT_EQ(try_clip(path) == Outcome::kRefused, victim.name == "dice_invalid_color.cine");
  }
  // Many changes hit what a reader does not use, many hit what it must refuse.
  EXPECT_GT(read, 1000);
  EXPECT_GT(refused, 1000);
}

TEST_F(Damage, EmptyFiles) {
  for (const char* extension : {"cine", "mraw", "cih", "cihx", "tif", "avi", "png", "txt"}) {
    const std::string path = folder_.file(std::string("empty.") + extension);
    write_bytes(path, {});
    EXPECT_EQ(try_clip(path), Outcome::kRefused) << extension;
  }
}

TEST_F(Damage, TheContentsTellTheFormat) {
  for (const Victim& victim : victims(folder_)) {
    const std::string& name = victim.name;
    if (name.find(".cine") == std::string::npos && name.find(".tif") == std::string::npos) continue;
    if (name.starts_with("hypercine") || name.find("color") != std::string::npos) continue;
    for (const char* extension : {"txt", "tif", "cine", "avi"}) {
      const std::string path = folder_.file(std::string("renamed.") + extension);
      write_bytes(path, victim.bytes);
      EXPECT_EQ(try_clip(path), Outcome::kRead) << name << " as " << extension;
    }
  }
  // And what is no video stays none, whatever it is called.
  for (const char* extension : {"txt", "tif", "cine", "avi", "cih", "cihx", "mraw", "png"}) {
    const std::string path = folder_.file(std::string("words.") + extension);
    const std::string words(5000, 'w');
    write_bytes(path, words.data(), words.size());
    EXPECT_EQ(try_clip(path), Outcome::kRefused) << extension;
  }
}

// A written cine of 8 bits and four frames with one field of the header replaced.
Outcome cine_with(const ScratchFolder& folder, std::size_t at, std::uint32_t value) {
  const std::string path = folder.file("changed.cine");
  write_clip(path, video::SinkFormat::kCine, 8);
  auto bytes = testing::file_bytes(path);
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(value >> (8 * i));
  write_bytes(path, bytes);
  return try_clip(path);
}

TEST_F(Damage, AbsurdCineFields) {
  EXPECT_EQ(cine_with(folder_, 20, 4), Outcome::kRead);     // as it was
  EXPECT_EQ(cine_with(folder_, 20, 0), Outcome::kRefused);  // no frames
  EXPECT_EQ(cine_with(folder_, 20, 0xffffffff), Outcome::kRefused);
  EXPECT_EQ(cine_with(folder_, 48, 0), Outcome::kRefused);  // width
  EXPECT_EQ(cine_with(folder_, 48, 0x7fffffff), Outcome::kRefused);
  EXPECT_EQ(cine_with(folder_, 52, 0x80000000), Outcome::kRefused);  // height
  EXPECT_EQ(cine_with(folder_, 52, 1000000), Outcome::kRefused);
  EXPECT_EQ(cine_with(folder_, 24, 0xfffffff0), Outcome::kRefused);  // bitmap header's place
  EXPECT_EQ(cine_with(folder_, 28, 0xfffffff0), Outcome::kRefused);  // SETUP's place
  EXPECT_EQ(cine_with(folder_, 32, 0xfffffff0), Outcome::kRefused);  // frame table's place
  EXPECT_EQ(cine_with(folder_, 60, 77), Outcome::kRefused);          // unknown packing
}

TEST_F(Damage, AbsurdMrawHeaders) {
  write_bytes(folder_.file("a.mraw"), std::vector<char>(640));
  const auto outcome = [this](const std::string& lines) {
    const std::string text = "#Camera Information Header\n" + lines;
    write_bytes(folder_.file("a.cih"), text.data(), text.size());
    return try_clip(folder_.file("a.mraw"));
  };
  const std::string rest = "Image Width : 16\nImage Height : 20\nColor Bit : 8\n";
  EXPECT_EQ(outcome(rest + "Total Frame : 2\n"), Outcome::kRead);
  EXPECT_EQ(outcome(rest + "Total Frame: 2\nRecord Rate(fps): 10000.0\n"), Outcome::kRead);
  EXPECT_EQ(outcome(rest + "Total Frame : 3\n"), Outcome::kRefused);
  EXPECT_EQ(outcome(rest + "Total Frame : 0\n"), Outcome::kRefused);
  EXPECT_EQ(outcome(rest + "Total Frame : -1\n"), Outcome::kRefused);
  EXPECT_EQ(outcome(rest + "Total Frame : 9223372036854775807\n"), Outcome::kRefused);
  EXPECT_EQ(outcome(rest + "Total Frame : 1e300\n"), Outcome::kRefused);
  EXPECT_EQ(outcome(rest + "Total Frame : many\n"), Outcome::kRefused);
  EXPECT_EQ(outcome(rest), Outcome::kRefused);
  EXPECT_EQ(outcome("Image Width : 1048577\nImage Height : 1\nColor Bit : 8\nTotal Frame : 1\n"),
            Outcome::kRefused);
  EXPECT_EQ(outcome("Image Width : 1000000\nImage Height : 1000000\nColor Bit : 8\n"
                    "Total Frame : 1\n"),
            Outcome::kRefused);
  EXPECT_EQ(outcome("Image Width : 16\nImage Height : 20\nColor Bit : 24\nTotal Frame : 1\n"),
            Outcome::kRefused);
  EXPECT_EQ(outcome("Image Width : 16\nImage Height : 20\nColor Bit : 13\nTotal Frame : 1\n"),
            Outcome::kRefused);
}

TEST_F(Damage, LeftJustifiedPixelsComeToTheLowBits) {
  const char pixels[] = {'\xf0', '\xff', '\x10', '\x00'};  // 0xfff0, 0x0010
  write_bytes(folder_.file("b.mraw"), pixels, 4);
  const auto write_header = [this](const std::string& depth_and_side) {
    const std::string text =
        "#Camera Information Header\nImage Width : 2\nImage Height : 1\nColor Bit : 16\n"
        "Total Frame : 1\n" +
        depth_and_side;
    write_bytes(folder_.file("b.cih"), text.data(), text.size());
  };
  write_header("EffectiveBit Depth : 12\nEffectiveBit Side : Higher\n");
  const auto clip = video::open_video({folder_.file("b.mraw")});
  Frame frame;
  clip->read(0, frame);
  EXPECT_EQ(frame.bits, 12);
  EXPECT_EQ(frame.u16(0, 0), 0xfff);
  EXPECT_EQ(frame.u16(1, 0), 1);
  // The same pixels cannot be 12 bits from below.
  write_header("EffectiveBit Depth : 12\nEffectiveBit Side : Lower\n");
  EXPECT_EQ(try_clip(folder_.file("b.mraw")), Outcome::kRefused);
  // Eight effective bits make an 8-bit frame.
  write_header("EffectiveBit Depth : 8\nEffectiveBit Side : Higher\n");
  video::open_video({folder_.file("b.mraw")})->read(0, frame);
  EXPECT_EQ(frame.type, PixelType::kU8);
  EXPECT_EQ(frame.u8(0, 0), 0xff);
}

TEST_F(Damage, TiffPagesInALoop) {
  const std::string path = folder_.file("loop.tif");
  write_clip(path, video::SinkFormat::kTiff, 8);
  auto bytes = testing::file_bytes(path);
  // The first page's directory: its place, its count of tags, then the next page's place.
  const auto u16 = [&](std::size_t at) {
    return static_cast<std::uint8_t>(bytes[at]) | static_cast<std::uint8_t>(bytes[at + 1]) << 8;
  };
  const std::size_t first = static_cast<std::size_t>(u16(4) | u16(6) << 16);
  const std::size_t next = first + 2 + 12 * static_cast<std::size_t>(u16(first));
  for (std::size_t i = 0; i < 4; ++i) bytes[next + i] = bytes[4 + i];
  write_bytes(path, bytes);
  EXPECT_EQ(try_clip(path), Outcome::kRefused);
}

TEST_F(Damage, RawLayouts) {
  write_bytes(folder_.file("a.bin"), std::vector<char>(100));
  OpenOptions options;
  const auto outcome = [&](const std::string& text) {
    options.raw = video::parse_raw_layout(text);
    return try_clip(folder_.file("a.bin"), options);
  };
  EXPECT_EQ(outcome("10x5x8"), Outcome::kRead);
  EXPECT_EQ(outcome("10x5x16"), Outcome::kRead);
  EXPECT_EQ(outcome("10x11x8"), Outcome::kRefused);  // longer than the file
  EXPECT_EQ(outcome("1048576x1048576x8"), Outcome::kRefused);
  for (const char* bad :
       {"", "10x5", "10x5x9", "0x5x8", "-1x5x8", "10x5x8x1", "axbxc", "99999999999999999999x5x8"}) {
    EXPECT_THROW(video::parse_raw_layout(bad), InvalidArgument) << bad;
  }
}

TEST_F(Damage, WhatIsNotThere) {
  EXPECT_THROW(video::open_video({}), InvalidArgument);
  EXPECT_THROW(video::open_video({folder_.file("no.cine")}), FileError);
  EXPECT_THROW(video::open_video({folder_.file("no*.tif")}), FileError);
  EXPECT_THROW(video::open_video({folder_.file(std::string(5000, 'n') + ".mraw")}), FileError);
  EXPECT_THROW(video::open_video({folder_.file("")}),
               InvalidArgument);  // a folder without pictures
  victims(folder_);
  EXPECT_THROW(video::open_video({folder_.file("made_8.cine"), folder_.file("made_16.cine")}),
               InvalidArgument);
  write_bytes(folder_.file("a.png"), std::vector<char>(10));
  EXPECT_THROW(video::open_video({folder_.file("")}), InvalidArgument);  // .png and .tif
}

TEST(NaturalOrder, NumbersCountAsNumbers) {
  EXPECT_TRUE(video::natural_less("f9.tif", "f10.tif"));
  EXPECT_FALSE(video::natural_less("f10.tif", "f9.tif"));
  EXPECT_TRUE(video::natural_less("f009.tif", "f10.tif"));
  EXPECT_TRUE(video::natural_less("f9.tif", "f009.tif"));
  EXPECT_TRUE(video::natural_less("a2b3", "a2b20"));
  EXPECT_TRUE(video::natural_less("a", "a1"));
  EXPECT_TRUE(video::natural_less("a1", "b0"));
  EXPECT_FALSE(video::natural_less("a1", "a1"));
  EXPECT_TRUE(video::natural_less("x99999999999999999999998", "x99999999999999999999999"));
}

}  // namespace
}  // namespace impactdic
