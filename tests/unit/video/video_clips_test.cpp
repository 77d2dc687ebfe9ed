// Real camera files: against frames decoded by another reader, against ffmpeg, against facts.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>

#include "host/video/frame_source.h"
#include "tests/support/data.h"
#include "tests/support/video.h"

namespace impactdic {
namespace {

using testing::data_path;

std::unique_ptr<FrameSource> open_data(const std::string& name, bool phantom_codes = false) {
  OpenOptions options;
  options.phantom_codes = phantom_codes;
  return video::open_video({data_path(name).string()}, options);
}

int level(const Frame& frame, std::size_t i) {
  return frame.type == PixelType::kU8 ? frame.u8.data()[i] : frame.u16.data()[i];
}

// Pixels that differ between a frame, its levels mapped to 8 bits, and a gold picture.
int differing(const std::string& cine, std::int64_t index, const std::string& gold,
              const std::function<int(int)>& to_8_bits, bool phantom_codes = false) {
  Frame frame, expected;
  open_data(cine, phantom_codes)->read(index, frame);
  open_data(gold)->read(0, expected);
  if (frame.width() != expected.width() || frame.height() != expected.height()) return -1;
  int count = 0;
  for (std::size_t i = 0; i < expected.u8.size(); ++i) {
    count += to_8_bits(level(frame, i)) != expected.u8.data()[i] ? 1 : 0;
  }
  return count;
}

TEST(CineClips, EqualTheGoldFramesBitForBit) {
  IMPACTDIC_NEED_DATA("cine");
  // "frame_11" counts from 1. This file has no SETUP, no mark and no annotations.
  EXPECT_EQ(differing("cine/hypercine_example_8bpp.cine", 10,
                      "cine/hypercine_gold_example_8bpp_frame_11.tiff", [](int v) { return v; }),
            0);
  // The gold pictures are 8-bit: 12 bits were scaled by 255/4095 in single precision and cut off,
  EXPECT_EQ(
      differing("cine/dice_phantom_v7_raw_16bpp.cine", 0,
                "cine/hypercine_gold_phantom_v7_raw_16bpp_frame_238292.tiff",
                [](int v) { return static_cast<int>(static_cast<float>(v) * (255.0f / 4095)); }),
      0);
  // and 10-bit codes, not linearised, by 255/1023 and rounded.
  EXPECT_EQ(differing(
                "cine/dice_packed_12bpp.cine", 0, "cine/hypercine_gold_packed_12bpp_frame_60.tiff",
                [](int v) { return static_cast<int>(std::lround(v * 255.0 / 1023)); }, true),
            0);
}

TEST(CineClips, MeanOfAllFramesEqualsTheGoldMean) {
  IMPACTDIC_NEED_DATA("cine");
  const auto clip = open_data("cine/hypercine_example_8bpp.cine");
  ASSERT_EQ(clip->info().frame_count, 11);
  Frame frame, expected;
  open_data("cine/hypercine_gold_avg_frame_8_bit.tif")->read(0, expected);
  std::vector<int> sum(expected.u8.size(), 0);
  for (int k = 0; k < 11; ++k) {
    clip->read(k, frame);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += level(frame, i);
  }
  for (std::size_t i = 0; i < sum.size(); ++i) ASSERT_EQ(sum[i] / 11, expected.u8.data()[i]) << i;
}

// All of ffmpeg's frames as 16-bit pixels; empty where ffmpeg is not there.
std::vector<std::uint16_t> ffmpeg_pixels(const std::filesystem::path& path) {
  const std::string command =
      "ffmpeg -v error -i '" + path.string() + "' -pix_fmt gray16le -f rawvideo - 2>/dev/null";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  std::vector<std::uint16_t> pixels;
  std::uint16_t buffer[4096];
  while (pipe != nullptr) {
    const std::size_t got = std::fread(buffer, 2, std::size(buffer), pipe);
    if (got == 0) break;
    pixels.insert(pixels.end(), buffer, buffer + got);
  }
  if (pipe != nullptr) ::pclose(pipe);
  return pixels;
}

// ffmpeg spreads the levels over 16 bits by repeating the highest bits below.
std::uint16_t spread(int level, int bits) {
  return static_cast<std::uint16_t>(level << (16 - bits) | level >> (2 * bits - 16));
}

void expect_as_ffmpeg(const std::string& path) {
  if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) GTEST_SKIP() << "needs ffmpeg";
  OpenOptions options;
  options.phantom_codes = true;  // ffmpeg does not linearise
  const auto clip = video::open_video({path}, options);
  const ClipInfo& info = clip->info();
  const auto expected = ffmpeg_pixels(path);
  const std::size_t pixels = static_cast<std::size_t>(info.width) * info.height;
  ASSERT_EQ(expected.size(), pixels * static_cast<std::size_t>(info.frame_count));
  Frame frame;
  for (std::int64_t k = 0; k < info.frame_count; ++k) {
    clip->read(k, frame);
    for (std::size_t i = 0; i < pixels; ++i) {
      ASSERT_EQ(spread(level(frame, i), info.bits),
                expected[static_cast<std::size_t>(k) * pixels + i])
          << "frame " << k << ", pixel " << i;
    }
  }
}

class CineOracle : public ::testing::TestWithParam<const char*> {};

TEST_P(CineOracle, EqualsFfmpegBitForBit) {
  const std::string name = std::string("cine/") + GetParam() + ".cine";
  IMPACTDIC_NEED_DATA(name);
  expect_as_ffmpeg(data_path(name).string());
}

// Of the files that impactdic writes; ffmpeg does not know packed 12 bits.
TEST(WrittenCine, IsReadByFfmpegBitForBit) {
  const testing::ScratchFolder folder;
  for (const auto& [format, bits] : {std::pair{video::SinkFormat::kCine, 8},
                                     {video::SinkFormat::kCine, 12},
                                     {video::SinkFormat::kCinePacked10, 10}}) {
    ClipInfo info;
    info.width = 64;
    info.height = 48;
    info.bits = bits;
    info.frame_count = 3;
    info.fps = 10000;
    const std::string path = folder.file(std::to_string(bits) + ".cine");
    const auto sink = video::open_sink(path, format, info);
    for (std::uint32_t k = 0; k < 3; ++k) sink->write(testing::random_frame(64, 48, bits, k));
    sink->finish();
    expect_as_ffmpeg(path);
  }
}

INSTANTIATE_TEST_SUITE_P(Files, CineOracle,
                         ::testing::Values("dice_packed_12bpp", "dice_phantom_v12_raw_16bpp",
                                           "dice_phantom_v1610", "dice_phantom_v7_raw_16bpp",
                                           "dice_phantom_v9_raw_16bpp", "pyidi_data_small_cine"));

TEST(CineClips, FactsOfTheHeader) {
  IMPACTDIC_NEED_DATA("cine");
  const auto clip = open_data("cine/dice_phantom_v7_raw_16bpp.cine");
  const ClipInfo& info = clip->info();
  EXPECT_EQ(info.format, "Phantom cine");
  EXPECT_EQ(info.storage, "16-bit little-endian");
  EXPECT_EQ(info.bits, 12);
  EXPECT_EQ(info.frame_count, 6);
  EXPECT_EQ(info.first_frame_number, 238292);
  EXPECT_DOUBLE_EQ(info.fps.value(), 80);
  EXPECT_DOUBLE_EQ(info.exposure_s.value(), 0.012);
  EXPECT_EQ(info.recorded_at.value(), "2015-07-23T20:36:30.160245Z");
  EXPECT_TRUE(info.has_timestamps);
  // The camera's clock jitters by 0.2 µs.
  EXPECT_NEAR(clip->frame_time_s(5).value(), 5 / 80.0, 1e-6);
  EXPECT_EQ(clip->frame_time_s(0).value(), 0);
  EXPECT_NEAR(clip->frame_exposure_s(0).value(), 0.012, 2e-6);
  EXPECT_TRUE(info.warnings.empty());
}

TEST(CineClips, Packed10IsLinearisedTo12Bits) {
  IMPACTDIC_NEED_DATA("cine");
  const auto codes = open_data("cine/dice_packed_12bpp.cine", true);
  const auto linear = open_data("cine/dice_packed_12bpp.cine");
  EXPECT_EQ(codes->info().bits, 10);
  EXPECT_EQ(linear->info().bits, 12);
  Frame raw, frame;
  codes->read(3, raw);
  linear->read(3, frame);
  EXPECT_EQ(frame.bits, 12);
  // Entries of the published table, with the pixels of this frame that have each code.
  const std::map<int, int> table = {{0, 2}, {64, 64}, {256, 290}, {304, 383}, {400, 623}};
  std::map<int, int> seen;
  for (std::size_t i = 0; i < raw.u16.size(); ++i) {
    const auto entry = table.find(raw.u16.data()[i]);
    if (entry == table.end()) continue;
    ASSERT_EQ(frame.u16.data()[i], entry->second);
    ++seen[entry->first];
  }
  EXPECT_EQ(seen.size(), table.size());
}

TEST(CineClips, AWrongTimeStampIsSaidAndNotUsed) {
  IMPACTDIC_NEED_DATA("cine");
  // Its last stamp is 293 days late.
  const auto clip = open_data("cine/pyidi_data_small_cine.cine");
  EXPECT_DOUBLE_EQ(clip->info().fps.value(), 100);
  EXPECT_EQ(clip->info().record_step, 1);
  EXPECT_EQ(clip->info().frame_count, 235);
  EXPECT_FALSE(clip->info().has_timestamps);
  EXPECT_FALSE(clip->frame_time_s(3).has_value());
  ASSERT_EQ(clip->info().warnings.size(), 1u);
  EXPECT_NE(clip->info().warnings[0].find("frame 234"), std::string::npos);
}

TEST(CineClips, ColourIsRefused) {
  IMPACTDIC_NEED_DATA("cine");
  try {
    open_data("cine/dice_invalid_color.cine");
    FAIL() << "opened";
  } catch (const FormatError& error) {
    EXPECT_NE(error.line().find("colour"), std::string::npos) << error.line();
  }
}

TEST(MrawClips, BallIs12BitPacked) {
  IMPACTDIC_NEED_DATA("mraw/ball_12bit.mraw");
  for (const char* name : {"mraw/ball_12bit.cihx", "mraw/ball_12bit.mraw"}) {
    const auto clip = open_data(name);
    const ClipInfo& info = clip->info();
    EXPECT_EQ(info.width, 384);
    EXPECT_EQ(info.height, 384);
    EXPECT_EQ(info.bits, 12);
    EXPECT_EQ(info.storage, "12-bit packed");
    EXPECT_EQ(info.frame_count, 15);
    EXPECT_EQ(info.first_frame_number, 52);
    EXPECT_DOUBLE_EQ(info.fps.value(), 30000);
    EXPECT_EQ(info.record_step, 1);
    EXPECT_DOUBLE_EQ(info.exposure_s.value(), 20e-6);
    EXPECT_NE(info.camera.find("Nova S16"), std::string::npos);
  }
}

// The dark disc of the ball, by its area's centre: falls by 2.647 px a frame.
double dark_centre_y(const Frame& frame) {
  double weight = 0, sum = 0;
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      if (frame.u16(x, y) < 2000) weight += 1, sum += y;
    }
  }
  return sum / weight;
}

TEST(MrawClips, BallFalls) {
  IMPACTDIC_NEED_DATA("mraw/ball_12bit.mraw");
  const auto clip = open_data("mraw/ball_12bit.mraw");
  Frame first, last;
  clip->read(0, first);
  clip->read(4, last);
  // Packed the wrong way round, or shifted by half a byte, nothing would move smoothly; the
  // centre of the thresholded area is good to 0.1 px.
  EXPECT_NEAR((dark_centre_y(last) - dark_centre_y(first)) / 4, 2.647, 0.1);
}

TEST(MrawClips, EveryNthFrameLowersTheRate) {
  IMPACTDIC_NEED_DATA("mraw/beam.mraw");
  const auto beam = open_data("mraw/beam.cihx");
  EXPECT_EQ(beam->info().bits, 12);
  EXPECT_EQ(beam->info().width, 1024);
  EXPECT_EQ(beam->info().height, 80);
  EXPECT_EQ(beam->info().frame_count, 4);
  EXPECT_EQ(beam->info().record_step, 2500);
  EXPECT_DOUBLE_EQ(beam->info().fps.value() * 2500, 50000);
  Frame frame;
  for (int k = 0; k < 4; ++k) beam->read(k, frame);  // 12 bits hold every pixel
  EXPECT_EQ(frame.bits, 12);

  const auto showcase = open_data("mraw/data_showcase.cih");
  EXPECT_EQ(showcase->info().bits, 8);  // the upper 8 of the camera's 12
  EXPECT_EQ(showcase->info().frame_count, 75);
  EXPECT_EQ(showcase->info().record_step, 100);
  EXPECT_DOUBLE_EQ(showcase->info().fps.value(), 150);
  EXPECT_DOUBLE_EQ(showcase->info().exposure_s.value(), 65060e-9);
  showcase->read(74, frame);
  EXPECT_EQ(frame.type, PixelType::kU8);
  const auto bytes = testing::file_bytes(data_path("mraw/data_showcase.mraw"));
  EXPECT_EQ(frame.u8(639, 39), static_cast<std::uint8_t>(bytes.back()));
  EXPECT_EQ(frame.u8(0, 0), static_cast<std::uint8_t>(bytes[74 * 640 * 40]));
}

TEST(MrawClips, AMissingHalfIsNamed) {
  IMPACTDIC_NEED_DATA("mraw/sample_60k_16bit.cih");
  try {
    open_data("mraw/sample_60k_16bit.cih");
    FAIL() << "opened";
  } catch (const FileError& error) {
    EXPECT_NE(error.line().find("sample_60k_16bit.mraw"), std::string::npos) << error.line();
  }
  const testing::ScratchFolder folder;
  testing::write_bytes(folder.file("lonely.mraw"), std::vector<char>(100));
  try {
    video::open_video({folder.file("lonely.mraw")});
    FAIL() << "opened";
  } catch (const FileError& error) {
    EXPECT_NE(error.line().find(".cihx"), std::string::npos) << error.line();
  }
}

TEST(TiffClips, ColourLzwBecomesLuminance) {
  IMPACTDIC_NEED_DATA("speckle/rotation_170.tif");
  const auto grey = open_data("speckle/rotation_000.tif");
  const auto colour = open_data("speckle/rotation_170.tif");
  EXPECT_EQ(colour->info().width, 512);
  EXPECT_EQ(colour->info().storage, "8-bit, LZW");
  Frame a, b;
  grey->read(0, a);
  colour->read(0, b);
  ASSERT_EQ(b.type, PixelType::kU8);
  // A rotation keeps the mean level of the disc that stays in the picture.
  double mean_a = 0, mean_b = 0;
  for (int y = 156; y < 356; ++y) {
    for (int x = 156; x < 356; ++x) mean_a += a.u8(x, y), mean_b += b.u8(x, y);
  }
  EXPECT_NEAR(mean_b / mean_a, 1, 0.05);
}

TEST(Sequences, FolderPatternAndListAreOne) {
  IMPACTDIC_NEED_DATA("wheel/mechanism_4870.tif");
  const std::string folder = data_path("wheel").string();
  const auto whole = video::open_video({folder});
  const auto pattern = video::open_video({folder + "/mechanism_49*.tif"});
  const auto list =
      video::open_video({folder + "/mechanism_4871.tif", folder + "/mechanism_4870.tif"});
  EXPECT_EQ(whole->info().frame_count, 56);
  EXPECT_EQ(pattern->info().frame_count, 26);
  EXPECT_EQ(list->info().frame_count, 2);
  Frame a, b;
  whole->read(30, a);
  pattern->read(0, b);
  EXPECT_TRUE(testing::same_pixels(a, b));
  whole->read(0, a);
  list->read(1, b);  // a list keeps its order
  EXPECT_TRUE(testing::same_pixels(a, b));
}

}  // namespace
}  // namespace impactdic
