// What the writers store, the readers give back: every format and depth.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <thread>

#include "host/base/sha256.h"
#include "host/video/clip_digest.h"
#include "host/video/codec_module.h"
#include "host/video/frame_sink.h"
#include "host/video/unpack.h"
#include "tests/support/video.h"

namespace impactdic {
namespace {

using testing::random_frame;
using testing::same_pixels;
using testing::ScratchFolder;

struct Case {
  video::SinkFormat format;
  int bits;
  int width, height;
  const char* storage;
};

std::string name_of(const ::testing::TestParamInfo<Case>& info) {
  return "f" + std::to_string(static_cast<int>(info.param.format)) + "_" +
         std::to_string(info.param.bits) + "bit_" + std::to_string(info.param.width) + "x" +
         std::to_string(info.param.height);
}

class RoundTrip : public ::testing::TestWithParam<Case> {};

TEST_P(RoundTrip, PixelsAndFactsSurvive) {
  const Case& it = GetParam();
  const ScratchFolder folder;
  ClipInfo info;
  info.width = it.width;
  info.height = it.height;
  info.bits = it.bits;
  info.frame_count = 5;
  info.first_frame_number = -2;
  info.fps = 9876.5;
  info.exposure_s = 20e-6;
  info.camera = "synthetic";
  const std::string path = folder.file("clip" + video::sink_extension(it.format));
  auto sink = video::open_sink(path, it.format, info);
  for (std::uint32_t k = 0; k < 5; ++k) sink->write(random_frame(it.width, it.height, it.bits, k));
  sink->finish();
  sink.reset();

  OpenOptions options;
  options.phantom_codes = true;  // the 10-bit codes as they are
  if (it.format == video::SinkFormat::kRaw) {
    options.raw = RawLayout{it.width, it.height, it.bits <= 8 ? 8 : 16};
  }
  const auto clip = video::open_video({path}, options);
  const ClipInfo& read = clip->info();
  EXPECT_EQ(read.frame_count, 5);
  EXPECT_EQ(read.width, it.width);
  EXPECT_EQ(read.height, it.height);
  EXPECT_EQ(read.storage, it.storage);
  EXPECT_TRUE(read.warnings.empty()) << read.warnings.front();
  if (it.format != video::SinkFormat::kRaw) {
    EXPECT_EQ(read.bits, it.bits);
    EXPECT_EQ(read.camera, info.camera);
    ASSERT_TRUE(read.fps && read.exposure_s);
    EXPECT_DOUBLE_EQ(*read.fps, 9876.5);
    EXPECT_DOUBLE_EQ(*read.exposure_s, 20e-6);
  }
  if (it.format != video::SinkFormat::kRaw && it.format != video::SinkFormat::kTiff) {
    EXPECT_EQ(read.first_frame_number, -2);
  }
  Frame frame;
  for (std::uint32_t k : {4u, 0u, 3u, 1u, 2u}) {
    clip->read(k, frame);
    EXPECT_TRUE(same_pixels(frame, random_frame(it.width, it.height, it.bits, k))) << k;
    EXPECT_EQ(frame.bits, read.bits);
  }
  if (read.has_timestamps) {
    // Stamps are stored in steps of 2^-30 s.
    EXPECT_NEAR(clip->frame_time_s(4).value(), 4 / 9876.5, 1.0 / (1 << 30));
    EXPECT_NEAR(clip->frame_exposure_s(4).value(), 20e-6, 1.0 / (1 << 30));
  }
  EXPECT_THROW(clip->read(5, frame), InvalidArgument);
  EXPECT_THROW(clip->read(-1, frame), InvalidArgument);
}

// A camera stamps whole microseconds: frames of 28.5 µs are stamped 28 and 29 µs apart.
TEST(CineTimes, StampsOfWholeMicrosecondsAreTheHeadersRate) {
  const testing::ScratchFolder folder;
  const std::string path = (folder / "fast.cine").string();
  const double interval_s = 28.5e-6;
  ClipInfo info;
  info.width = 16;
  info.height = 8;
  info.bits = 8;
  constexpr int kFrames = 9;
  info.fps = 1 / interval_s;
  info.frame_count = kFrames;
  info.exposure_s = 5e-6;
  const auto sink = video::open_sink(path, video::SinkFormat::kCine, info);
  for (std::uint32_t k = 0; k < kFrames; ++k) sink->write(random_frame(16, 8, 8, k));
  sink->finish();
  std::string bytes = testing::read_text(path);
  const auto stamp = [&](std::size_t at) {
    std::uint64_t value = 0;
    if (at + 8 <= bytes.size()) std::memcpy(&value, &bytes[at], 8);
    return value;
  };
  // The stamps are eight bytes each, in 2^-32 s, one after the other.
  std::size_t first = 0;
  const auto is_stamps = [&](std::size_t at) {
    for (std::size_t k = 0; k + 1 < kFrames; ++k) {
      const double step = static_cast<double>(stamp(at + 8 * (k + 1)) - stamp(at + 8 * k));
      if (std::abs(step - interval_s * 0x1p32) > 8) return false;
    }
    return true;
  };
  while (first < bytes.size() && !is_stamps(first)) ++first;
  ASSERT_LT(first, bytes.size());
  for (std::size_t k = 0; k < kFrames; ++k) {
    const double whole_s = std::floor(static_cast<double>(k) * 28.5) * 1e-6;
    const std::uint64_t value = stamp(first) + static_cast<std::uint64_t>(whole_s * 0x1p32);
    if (k > 0) std::memcpy(&bytes[first + 8 * k], &value, 8);
  }
  std::ofstream(path, std::ios::binary) << bytes;
  const ClipInfo read = video::open_video({path})->info();
  EXPECT_TRUE(read.warnings.empty()) << read.warnings.front();
  EXPECT_TRUE(read.has_timestamps);
  EXPECT_DOUBLE_EQ(read.fps.value(), 1 / interval_s);
}

INSTANTIATE_TEST_SUITE_P(
    Formats, RoundTrip,
    ::testing::Values(Case{video::SinkFormat::kTiff, 8, 33, 17, "8-bit, uncompressed"},
                      Case{video::SinkFormat::kTiff, 12, 33, 17, "16-bit, uncompressed"},
                      Case{video::SinkFormat::kTiff, 16, 64, 48, "16-bit, uncompressed"},
                      Case{video::SinkFormat::kRaw, 8, 33, 17, "8-bit"},
                      Case{video::SinkFormat::kRaw, 16, 33, 17, "16-bit little-endian"},
                      Case{video::SinkFormat::kCine, 8, 33, 17, "8-bit"},
                      Case{video::SinkFormat::kCine, 12, 33, 17, "16-bit little-endian"},
                      Case{video::SinkFormat::kCine, 16, 64, 48, "16-bit little-endian"},
                      Case{video::SinkFormat::kCinePacked10, 10, 64, 48, "10-bit packed"},
                      Case{video::SinkFormat::kCinePacked10, 10, 33, 17, "10-bit packed"},
                      Case{video::SinkFormat::kCinePacked10, 10, 33, 19, "10-bit packed"},
                      Case{video::SinkFormat::kCinePacked12, 12, 64, 48, "12-bit packed"},
                      Case{video::SinkFormat::kCinePacked12, 12, 33, 17, "12-bit packed"},
                      Case{video::SinkFormat::kMraw, 8, 33, 17, "8-bit"},
                      Case{video::SinkFormat::kMraw, 12, 33, 17, "16-bit little-endian"},
                      Case{video::SinkFormat::kMraw, 16, 64, 48, "16-bit little-endian"},
                      Case{video::SinkFormat::kMrawPacked12, 12, 64, 48, "12-bit packed"},
                      Case{video::SinkFormat::kMrawPacked12, 12, 33, 17, "12-bit packed"}),
    name_of);

TEST(Unpack, PackedGroupsByHand) {
  // 0x3ff, 0, 0x2aa, 0x155 and 0xabc, 0x123, most significant bit first.
  const std::uint8_t ten[] = {0xff, 0xc0, 0x0a, 0xa9, 0x55};
  std::uint16_t out[4];
  video::unpack_10(ten, 4, out);
  EXPECT_EQ(std::vector<std::uint16_t>(out, out + 4),
            (std::vector<std::uint16_t>{0x3ff, 0, 0x2aa, 0x155}));
  const std::uint8_t twelve[] = {0xab, 0xc1, 0x23};
  video::unpack_12(twelve, 2, out);
  EXPECT_EQ(out[0], 0xabc);
  EXPECT_EQ(out[1], 0x123);
}

TEST(Unpack, TransferCurveGrowsAndInverts) {
  const std::uint16_t* linear = video::phantom_linear_10();
  EXPECT_EQ(linear[0], 2);
  EXPECT_EQ(linear[1014], 4064);
  EXPECT_EQ(linear[1023], 4095);
  for (int code = 1; code < 1024; ++code) {
    ASSERT_GE(linear[code], linear[code - 1]) << code;
    ASSERT_LE(linear[code] - linear[code - 1], code == 1015 ? 31 : 9) << code;
  }
  for (int value = 0; value < 4096; ++value) {
    const int code = video::phantom_code_10(static_cast<std::uint16_t>(value));
    int best = 4096;
    for (int k = 0; k < 1024; ++k) best = std::min(best, std::abs(linear[k] - value));
    ASSERT_EQ(std::abs(linear[code] - value), best) << value;
  }
}

TEST(CineSink, Linear12BitsThroughTheTransferCurveErrByHalfAStep) {
  const ScratchFolder folder;
  ClipInfo info;
  info.width = 64;
  info.height = 48;
  info.bits = 12;
  info.frame_count = 1;
  const std::string path = folder.file("clip.cine");
  const Frame original = random_frame(64, 48, 12, 7);
  auto sink = video::open_sink(path, video::SinkFormat::kCinePacked10, info);
  sink->write(original);
  sink->finish();
  const auto clip = video::open_video({path});
  EXPECT_EQ(clip->info().bits, 12);
  Frame frame;
  clip->read(0, frame);
  for (std::size_t i = 0; i < frame.u16.size(); ++i) {
    // The widest step between neighbouring codes is 31 (4064 to 4095), elsewhere 9.
    const int most = original.u16.data()[i] > 4064 ? 15 : 4;
    ASSERT_LE(std::abs(frame.u16.data()[i] - original.u16.data()[i]), most);
  }
}

TEST(FrameSink, AnUnfinishedClipLeavesNoFile) {
  const ScratchFolder folder;
  ClipInfo info;
  info.width = info.height = 16;
  info.frame_count = 2;
  for (const video::SinkFormat format : {video::SinkFormat::kTiff, video::SinkFormat::kRaw,
                                         video::SinkFormat::kCine, video::SinkFormat::kMraw}) {
    const std::string path = folder.file("clip" + video::sink_extension(format));
    auto sink = video::open_sink(path, format, info);
    sink->write(random_frame(16, 16, 8, 1));
    if (format == video::SinkFormat::kCine) {
      EXPECT_THROW(sink->finish(), InvalidArgument);
    }
    sink.reset();
    EXPECT_FALSE(std::filesystem::exists(path)) << path;
  }
}

TEST(FrameSink, RefusesWhatItCannotStore) {
  const ScratchFolder folder;
  ClipInfo info;
  info.width = info.height = 16;
  info.frame_count = 2;
  info.bits = 8;
  const std::string path = folder.file("clip");
  EXPECT_THROW(video::open_sink(path, video::SinkFormat::kCinePacked10, info), InvalidArgument);
  EXPECT_THROW(video::open_sink(path, video::SinkFormat::kCinePacked12, info), InvalidArgument);
  EXPECT_THROW(video::open_sink(path, video::SinkFormat::kMrawPacked12, info), InvalidArgument);
  if (!video::has_codecs()) {
    EXPECT_THROW(video::open_sink(path, video::SinkFormat::kPng, info), InvalidArgument);
  }
  EXPECT_THROW(video::open_sink(folder.file("no/such/clip"), video::SinkFormat::kRaw, info),
               FileError);
  EXPECT_THROW(video::open_sink(folder.file("no/such/clip"), video::SinkFormat::kTiff, info),
               FileError);
  EXPECT_THROW(video::parse_sink_format("gif"), InvalidArgument);
  const auto sink = video::open_sink(path, video::SinkFormat::kRaw, info);
  EXPECT_THROW(sink->write(random_frame(16, 17, 8, 1)), InvalidArgument);
  EXPECT_THROW(sink->write(random_frame(16, 16, 12, 1)), InvalidArgument);
  info.frame_count = 0;
  EXPECT_THROW(video::open_sink(path, video::SinkFormat::kCine, info), InvalidArgument);
}

// Four threads read all frames at once, each in another order.
class ManyThreads : public ::testing::TestWithParam<video::SinkFormat> {};

TEST_P(ManyThreads, ReadTheSamePixels) {
  const ScratchFolder folder;
  constexpr int kFrames = 24, kThreads = 4;
  ClipInfo info;
  info.width = 61;
  info.height = 37;
  info.bits = 12;
  info.frame_count = kFrames;
  const std::string path = folder.file("clip" + video::sink_extension(GetParam()));
  auto sink = video::open_sink(path, GetParam(), info);
  for (std::uint32_t k = 0; k < kFrames; ++k) sink->write(random_frame(61, 37, 12, k));
  sink->finish();
  const auto clip = video::open_video({path});
  std::vector<int> wrong(kThreads, 0);
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      Frame frame;
      for (int i = 0; i < kFrames; ++i) {
        const int k = (i * 7 + t * 5) % kFrames;
        clip->read(k, frame);
        const auto seed = static_cast<std::uint32_t>(k);
        if (!same_pixels(frame, random_frame(61, 37, 12, seed))) ++wrong[static_cast<size_t>(t)];
      }
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(kThreads, 0));
}

INSTANTIATE_TEST_SUITE_P(Formats, ManyThreads,
                         ::testing::Values(video::SinkFormat::kTiff, video::SinkFormat::kCine,
                                           video::SinkFormat::kCinePacked12,
                                           video::SinkFormat::kMrawPacked12));

std::string write_clip(const std::string& path, video::SinkFormat format, std::uint32_t seed) {
  ClipInfo info;
  info.width = info.height = 8;
  info.frame_count = 2;
  info.fps = 1000;
  auto sink = video::open_sink(path, format, info);
  for (std::uint32_t k = 0; k < 2; ++k) sink->write(random_frame(8, 8, 8, seed + k));
  sink->finish();
  return path;
}

// Whichever of the two files is named.
TEST(ClipDigest, CoversPixelsAndHeaderOfAPhotronPair) {
  const ScratchFolder folder;
  const std::string pixels = write_clip(folder.file("clip.mraw"), video::SinkFormat::kMraw, 1);
  for (const std::string& named : {pixels, folder.file("clip.cihx")}) {
    const video::ClipDigest digest = video::digest_of(video::open_video({named})->info());
    EXPECT_EQ(digest.sha256, sha256_of_file(pixels));
    EXPECT_EQ(digest.header_sha256, sha256_of_file(folder.file("clip.cihx")));
  }
  write_clip(folder.file("other.mraw"), video::SinkFormat::kMraw, 2);
  EXPECT_NE(sha256_of_file(pixels), sha256_of_file(folder.file("other.mraw")));
}

TEST(ClipDigest, OfALargeFileIsThatOfItsPieces) {
  const ScratchFolder folder;
  const std::string path =
      write_clip(folder.file("clip.mraw"), video::SinkFormat::kMraw, 1);  // 128 bytes
  const auto clip = video::open_video({path});
  const std::string pieces = sha256_of_part(path, 0, 50) + "  -\n" + sha256_of_part(path, 50, 50) +
                             "  -\n" + sha256_of_part(path, 100, 28) + "  -\n";
  EXPECT_EQ(video::digest_of(clip->info(), 50).sha256, sha256_of_text(pieces));
  const std::vector<char> bytes = testing::file_bytes(path);
  EXPECT_EQ(sha256_of_part(path, 50, 50), sha256_of_text({bytes.data() + 50, 50}));
  EXPECT_EQ(video::digest_of(clip->info(), 128).sha256, sha256_of_file(path));
}

TEST(ClipDigest, CoversEveryPictureOfASequence) {
  const ScratchFolder folder;
  const auto a = write_clip(folder.file("f2.tif"), video::SinkFormat::kTiff, 1);
  const auto b = write_clip(folder.file("f10.tif"), video::SinkFormat::kTiff, 5);
  const video::ClipDigest digest =
      video::digest_of(video::open_video({folder.file("f*.tif")})->info());
  EXPECT_EQ(digest.sha256,
            sha256_of_text(sha256_of_file(a) + "  f2.tif\n" + sha256_of_file(b) + "  f10.tif\n"));
  EXPECT_EQ(digest.header_sha256, "");
}

}  // namespace
}  // namespace impactdic
