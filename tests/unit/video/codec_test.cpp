// Containers and pictures through the codecs: exact where the codec is, in any order of reading.
#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <impactdic/safety/sandbox.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "host/video/codec_module.h"
#include "tests/support/data.h"
#include "tests/support/video.h"

namespace impactdic {
namespace {

using testing::data_path;
using testing::random_frame;
using testing::same_pixels;
using testing::ScratchFolder;

// The codecs themselves: sandbox_test tries the process that they else run in.
std::unique_ptr<FrameSource> open_clip(const std::string& path) {
  set_sandbox(false);
  return video::open_video({path});
}

const video::CodecModule& codecs() { return video::codec_module("", ""); }

// The largest difference to the upper 8 of the camera's 12 bits.
int worst_difference(const std::string& avi) {
  const auto truth = open_clip(data_path("mraw/ball_12bit.mraw").string());
  const auto clip = open_clip(data_path("avi/" + avi).string());
  EXPECT_EQ(clip->info().frame_count, 15);
  EXPECT_EQ(clip->info().bits, 8);
  Frame expected, frame;
  int worst = 0;
  for (int k = 0; k < 15; ++k) {
    truth->read(k, expected);
    clip->read(k, frame);
    for (int y = 0; y < frame.height(); ++y) {
      for (int x = 0; x < frame.width(); ++x) {
        worst = std::max(worst, std::abs(frame.u8(x, y) - (expected.u16(x, y) >> 4)));
      }
    }
  }
  return worst;
}

TEST(AviClips, UncompressedIsExactAndMjpgErrsAsKnown) {
  IMPACTDIC_NEED_DATA("avi/ball_Y800.avi");
  EXPECT_EQ(worst_difference("ball_Y800.avi"), 0);
  EXPECT_EQ(worst_difference("ball_DIB8_bottomup_w382.avi"), 0);  // 382 px: padded rows
  EXPECT_EQ(worst_difference("ball_MJPG.avi"), 13);
}

TEST(AviClips, WrongRatesAndLossAreSaid) {
  IMPACTDIC_NEED_DATA("avi/ball_MJPG.avi");
  const auto warned = [](const std::string& name, const std::string& words) {
    const auto clip = open_clip(data_path(name).string());
    for (const auto& warning : clip->info().warnings) {
      if (warning.find(words) != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(warned("avi/ball_MJPG.avi", "lossy"));
  EXPECT_TRUE(warned("avi/ball_MJPG.avi", "--fps"));  // states 600
  EXPECT_TRUE(warned("avi/ball_Y800.avi", "--fps"));
  EXPECT_FALSE(warned("avi/ball_Y800.avi", "lossy"));
  EXPECT_FALSE(warned("avi/ball_DIB8_bottomup_w382.avi", "--fps"));  // states 30000
}

// Reads frames in a bad order and compares with those read in order.
void expect_exact_in_any_order(const std::string& path) {
  std::vector<Frame> in_order;
  {
    const auto clip = open_clip(path);
    in_order.resize(static_cast<std::size_t>(clip->info().frame_count));
    for (std::size_t k = 0; k < in_order.size(); ++k) {
      clip->read(static_cast<std::int64_t>(k), in_order[k]);
    }
  }
  const auto clip = open_clip(path);
  std::mt19937 random(3);
  Frame frame;
  for (int i = 0; i < 60; ++i) {
    const std::size_t k = random() % in_order.size();
    clip->read(static_cast<std::int64_t>(k), frame);
    ASSERT_TRUE(same_pixels(frame, in_order[k])) << path << ", frame " << k;
  }
  EXPECT_THROW(clip->read(clip->info().frame_count, frame), InvalidArgument);
}

TEST(AviClips, AnyOrderGivesTheSameFrames) {
  IMPACTDIC_NEED_DATA("avi/ball_MJPG.avi");
  for (const char* name : {"ball_Y800.avi", "ball_MJPG.avi", "ball_DIB8_bottomup_w382.avi"}) {
    expect_exact_in_any_order(data_path(std::string("avi/") + name).string());
  }
}

// How a phone notes that it was held on its side: the matrix of the track's header (ISO/IEC
// 14496-12, 8.3.2), 36 bytes some way behind the box's name.
void set_turn(const std::string& path, int quarter_turns) {
  std::vector<char> bytes = testing::file_bytes(path);
  const std::string name = "tkhd";
  const auto box = std::search(bytes.begin(), bytes.end(), name.begin(), name.end());
  ASSERT_NE(box, bytes.end());
  constexpr int kRows[4][4] = {{1, 0, 0, 1}, {0, 1, -1, 0}, {-1, 0, 0, -1}, {0, -1, 1, 0}};
  constexpr std::ptrdiff_t kMatrix = 44, kPlaces[4] = {0, 4, 12, 16};
  for (int i = 0; i < 4; ++i) {
    const auto value = static_cast<std::uint32_t>(kRows[quarter_turns][i] * 65536);
    for (int byte = 0; byte < 4; ++byte) {
      box[kMatrix + kPlaces[i] + byte] = static_cast<char>(value >> (24 - 8 * byte));
    }
  }
  testing::write_bytes(path, bytes);
}

// The picture as it is meant to be seen: as ffmpeg shows it.
TEST(Videos, AreTurnedAsTheirTagSays) {
  if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) GTEST_SKIP() << "needs ffmpeg";
  const ScratchFolder folder;
  const std::string upright = folder.file("upright.mov"), pixels = folder.file("pixels");
  const Frame picture = random_frame(48, 32, 8, 3);
  testing::write_bytes(pixels, reinterpret_cast<const char*>(picture.u8.data()), 48 * 32);
  ASSERT_EQ(std::system(("ffmpeg -v error -f rawvideo -pix_fmt gray -s 48x32 -r 25 -i " + pixels +
                         " -c:v png -y " + upright)
                            .c_str()),
            0);
  for (int quarter_turns = 0; quarter_turns < 4; ++quarter_turns) {
    const std::string turned = folder.file("turned.mov"), shown = folder.file("shown");
    std::filesystem::copy_file(upright, turned, std::filesystem::copy_options::overwrite_existing);
    set_turn(turned, quarter_turns);
    ASSERT_EQ(
        std::system(
            ("ffmpeg -v error -i " + turned + " -f rawvideo -pix_fmt gray -y " + shown).c_str()),
        0);
    const auto clip = open_clip(turned);
    const bool on_its_side = quarter_turns % 2 == 1;
    ASSERT_EQ(clip->info().width, on_its_side ? 32 : 48) << quarter_turns;
    ASSERT_EQ(clip->info().height, on_its_side ? 48 : 32) << quarter_turns;
    Frame frame;
    clip->read(0, frame);
    const std::vector<char> want = testing::file_bytes(shown);
    ASSERT_EQ(want.size(), frame.u8.size());
    EXPECT_EQ(std::memcmp(want.data(), frame.u8.data(), want.size()), 0) << quarter_turns;
  }
}

TEST(Videos, SayWhereTheirPixelsAreNotSquare) {
  if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) GTEST_SKIP() << "needs ffmpeg";
  const ScratchFolder folder;
  const std::string film = folder.file("film.mov");
  const std::string made = "ffmpeg -v error -f lavfi -i testsrc=s=48x32:d=1 -vf setsar=16/15 ";
  ASSERT_EQ(std::system((made + film).c_str()), 0);
  const auto clip = open_clip(film);
  const auto names_it = [](const auto& warning) { return warning.find("16:15") != warning.npos; };
  const auto& said = clip->info().warnings;
  EXPECT_TRUE(std::any_of(said.begin(), said.end(), names_it));
}

std::string write_clip(const ScratchFolder& folder, video::SinkFormat format, int bits, int frames,
                       double fps = 10000) {
  ClipInfo info;
  info.width = 62;
  info.height = 38;
  info.bits = bits;
  info.fps = fps;
  const std::string path = folder.file("clip" + video::sink_extension(format));
  const auto sink = video::open_sink(path, format, info);
  for (int k = 0; k < frames; ++k) {
    sink->write(random_frame(62, 38, bits, static_cast<std::uint32_t>(k)));
  }
  sink->finish();
  return path;
}

TEST(CodecSinks, AviIsLosslessAndKeepsItsRate) {
  const ScratchFolder folder;
  for (const double fps : {10000.0, 30.0, 9876.5}) {
    const std::string path = write_clip(folder, video::SinkFormat::kAvi, 8, 70, fps);
    const auto clip = open_clip(path);
    ASSERT_EQ(clip->info().frame_count, 70);
    ASSERT_TRUE(clip->info().fps.has_value());
    EXPECT_NEAR(*clip->info().fps, fps, 1e-3);
    Frame frame;
    for (int k = 0; k < 70; ++k) {
      clip->read(k, frame);
      ASSERT_TRUE(same_pixels(frame, random_frame(62, 38, 8, static_cast<std::uint32_t>(k)))) << k;
    }
    expect_exact_in_any_order(path);
  }
}

TEST(CodecSinks, Mp4IsReadFrameByFrame) {
  const ScratchFolder folder;
  // Inter-frame compression: going back decodes again.
  const std::string path = write_clip(folder, video::SinkFormat::kMp4, 8, 70);
  const auto clip = open_clip(path);
  EXPECT_EQ(clip->info().frame_count, 70);
  EXPECT_NEAR(clip->info().fps.value(), 10000, 1);
  expect_exact_in_any_order(path);
}

TEST(CodecSinks, PngFolderKeepsEveryLevel) {
  for (const int bits : {8, 16}) {
    const ScratchFolder folder;
    const std::string path = write_clip(folder, video::SinkFormat::kPng, bits, 12);
    const auto clip = open_clip(path);
    ASSERT_EQ(clip->info().frame_count, 12);
    EXPECT_EQ(clip->info().bits, bits);
    Frame frame;
    for (const int k : {11, 0, 5}) {
      clip->read(k, frame);
      EXPECT_TRUE(same_pixels(frame, random_frame(62, 38, bits, static_cast<std::uint32_t>(k))));
    }
  }
}

TEST(CodecSinks, RefuseWhatTheyCannotStore) {
  const ScratchFolder folder;
  ClipInfo info;
  info.width = 63;
  info.height = 38;
  info.bits = 8;
  EXPECT_THROW(codecs().open_sink(folder.file("a.mp4"), video::SinkFormat::kMp4, info),
               InvalidArgument);
  EXPECT_THROW(codecs().open_mp4(folder.file("a.mp4"), 63, 38, 30), InvalidArgument);
  EXPECT_THROW(codecs().open_sink(folder.file("no/a.avi"), video::SinkFormat::kAvi, info),
               FileError);
  info.bits = 12;
  EXPECT_THROW(codecs().open_sink(folder.file("a.avi"), video::SinkFormat::kAvi, info),
               InvalidArgument);
  { const auto writer = codecs().open_mp4(folder.file("b.mp4"), 64, 64, 30); }
  EXPECT_FALSE(std::filesystem::exists(folder.file("b.mp4")));
}

TEST(CodecSinks, ColourMp4) {
  const ScratchFolder folder;
  const auto writer = codecs().open_mp4(folder.file("a.mp4"), 64, 48, 30);
  std::vector<std::uint8_t> red(64 * 48 * 3, 0);
  for (std::size_t i = 2; i < red.size(); i += 3) red[i] = 255;
  for (int k = 0; k < 3; ++k) writer->write(red.data(), 64 * 3);
  writer->finish();
  const auto clip = open_clip(folder.file("a.mp4"));
  EXPECT_EQ(clip->info().frame_count, 3);
  Frame frame;
  clip->read(1, frame);
  EXPECT_NEAR(frame.u8(32, 24), 76, 4);  // luminance of pure red: 0.299 · 255; lossy
  for (const Channel channel : {Channel::kRed, Channel::kBlue}) {
    OpenOptions options;
    options.channel = channel;
    video::open_video({folder.file("a.mp4")}, options)->read(1, frame);
    EXPECT_NEAR(frame.u8(32, 24), channel == Channel::kRed ? 255 : 0, 6);
  }
  // Of a kind that browsers play, where this FFmpeg can write one.
  const std::string bytes = testing::read_text(folder.file("a.mp4"));
  const bool played = bytes.find("avc1") != std::string::npos ||  //
                      bytes.find("vp09") != std::string::npos;
  if (!played) GTEST_SKIP() << "FFmpeg has no encoder of H.264 or VP9 here";
}

TEST(Pictures, BmpKeepsItsLevels) {
  IMPACTDIC_NEED_DATA("speckle/Pattern_1.bmp");
  const auto clip = video::open_video({data_path("speckle/Pattern_1.bmp").string(),
                                       data_path("speckle/Pattern_1_Shear.bmp").string()});
  EXPECT_EQ(clip->info().width, 501);
  EXPECT_EQ(clip->info().frame_count, 2);
  Frame frame;
  clip->read(0, frame);
  // Rows are stored from the bottom, 501 bytes padded to 504.
  const auto bytes = testing::file_bytes(data_path("speckle/Pattern_1.bmp"));
  const std::size_t pixels = bytes.size() - 504u * 501u;
  for (const int y : {0, 250, 500}) {
    for (int x = 0; x < 501; ++x) {
      ASSERT_EQ(
          frame.u8(x, y),
          static_cast<std::uint8_t>(
              bytes[pixels + 504u * static_cast<unsigned>(500 - y) + static_cast<unsigned>(x)]));
    }
  }
}

TEST(CodecDamage, CutAndChangedFilesEndInErrorsOrFrames) {
  const ScratchFolder folder;
  std::vector<std::string> paths = {write_clip(folder, video::SinkFormat::kAvi, 8, 6),
                                    write_clip(folder, video::SinkFormat::kMp4, 8, 6)};
  std::filesystem::create_directory(folder.file("png"));
  const ScratchFolder pictures;
  write_clip(pictures, video::SinkFormat::kPng, 8, 1);
  paths.push_back(pictures.file("clip/frame_000000.png"));
  std::mt19937 random(5);
  int refused = 0, read = 0;
  for (const std::string& path : paths) {
    const auto bytes = testing::file_bytes(path);
    const std::string damaged = folder.file("damaged" + path.substr(path.rfind('.')));
    for (int i = 0; i < 300; ++i) {
      auto copy = bytes;
      if (i % 3 == 0) {
        copy.resize(random() % bytes.size());
      } else {
        const std::size_t header = std::min<std::size_t>(bytes.size(), i % 3 == 1 ? 400 : 1u << 20);
        for (unsigned n = 0; n <= random() % 4; ++n) {
          copy[random() % header] = static_cast<char>(random());
        }
      }
      testing::write_bytes(damaged, copy);
      try {
        const auto clip = open_clip(damaged);
        Frame frame;
        clip->read(clip->info().frame_count - 1, frame);
        clip->read(0, frame);
        ++read;
      } catch (const FileError& error) {
        EXPECT_EQ(error.line().find('\n'), std::string::npos);
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(read, 100);
}

TEST(CodecThreads, ShareOneClip) {
  const ScratchFolder folder;
  const auto clip = open_clip(write_clip(folder, video::SinkFormat::kAvi, 8, 40));
  std::vector<int> wrong(3, 0);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < wrong.size(); ++t) {
    threads.emplace_back([&, t] {
      Frame frame;
      for (std::uint32_t k = static_cast<std::uint32_t>(t); k < 40; k += 3) {
        clip->read(k, frame);
        if (!same_pixels(frame, random_frame(62, 38, 8, k))) ++wrong[t];
      }
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(3, 0));
}

// A telephone notes in the track header how it was held.
TEST(Codec, FilmIsTurnedAsItIsToBeShown) {
  const ScratchFolder folder;
  const std::string path = folder.file("film.mp4");
  {
    const auto writer = codecs().open_mp4(path, 64, 48, 30);
    std::vector<std::uint8_t> bgr(64 * 48 * 3, 30);
    for (std::size_t y = 0; y < 16; ++y) {
      for (std::size_t x = 0; x < 3 * 16; ++x) bgr[3 * 64 * y + x] = 230;
    }
    for (int k = 0; k < 3; ++k) writer->write(bgr.data(), 64 * 3);
    writer->finish();
  }
  std::string bytes = testing::read_text(path);
  const std::size_t header = bytes.find("tkhd");
  ASSERT_NE(header, std::string::npos);
  const std::size_t matrix = header + 4 + (bytes[header + 4] == 1 ? 52 : 40);
  const char one[] = {0, 1, 0, 0}, minus[] = {-1, -1, 0, 0};
  // Turned clockwise by so many quarters: a, b, c, d; and where the bright corner then is.
  struct Turn {
    int a, b, c, d;
    bool right, bottom;
  };
  const Turn turns[] = {{1, 0, 0, 1, false, false},
                        {0, 1, -1, 0, true, false},
                        {-1, 0, 0, -1, true, true},
                        {0, -1, 1, 0, false, true}};
  for (int k = 0; k < 4; ++k) {
    const auto put = [&](int entry, int value) {
      const std::string four = value > 0   ? std::string(one, 4)
                               : value < 0 ? std::string(minus, 4)
                                           : std::string(4, '\0');
      bytes.replace(matrix + 4 * static_cast<std::size_t>(entry), 4, four);
    };
    put(0, turns[k].a);
    put(1, turns[k].b);
    put(3, turns[k].c);
    put(4, turns[k].d);
    std::ofstream(path, std::ios::binary) << bytes;
    const auto clip = open_clip(path);
    Frame frame;
    clip->read(1, frame);
    EXPECT_EQ(frame.width(), k % 2 == 0 ? 64 : 48);
    EXPECT_EQ(clip->info().width, frame.width());
    const int x = turns[k].right ? frame.width() - 5 : 4;
    const int y = turns[k].bottom ? frame.height() - 5 : 4;
    EXPECT_GT(frame.u8(x, y), 150) << k;
    EXPECT_LT(frame.u8(frame.width() - 1 - x, y), 90) << k;
    EXPECT_LT(frame.u8(x, frame.height() - 1 - y), 90) << k;
  }
}

}  // namespace
}  // namespace impactdic
