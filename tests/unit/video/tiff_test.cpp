// Every kind of TIFF that is read, written here with libtiff itself, and kinds that are refused.
#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <tiffio.h>

#include <functional>

#include "tests/support/video.h"

namespace impactdic {
namespace {

using testing::ScratchFolder;

constexpr int kWidth = 37, kHeight = 21;

struct Kind {
  const char* mode = "w";  // "wb": big-endian, "w8": BigTIFF
  int bits = 8;
  int samples = 1;
  int photometric = PHOTOMETRIC_MINISBLACK;
  int compression = COMPRESSION_NONE;
  int predictor = 1;
  int planar = PLANARCONFIG_CONTIG;
  int orientation = ORIENTATION_TOPLEFT;
  int rows_per_strip = 8;  // the last strip is not full
  int tile = 0;            // tile side, 0: strips
  int format = SAMPLEFORMAT_UINT;
};

// A sample's value: grey levels or colours that differ everywhere.
int sample(const Kind& kind, int x, int y, int channel) {
  const int value = (x * 6 + y * 3 + channel * 40) % 251;
  return kind.bits == 16 ? value * 257 + channel : value;
}

template <typename T>
void write_pixels(TIFF* tiff, const Kind& kind) {
  const int planes = kind.planar == PLANARCONFIG_SEPARATE ? kind.samples : 1;
  const int together = kind.samples / planes;
  for (int plane = 0; plane < planes; ++plane) {
    const auto fill = [&](std::vector<T>& row, int x0, int count, int y) {
      for (int x = 0; x < count; ++x) {
        for (int c = 0; c < together; ++c) {
          const bool inside = x0 + x < kWidth && y < kHeight;
          row.push_back(static_cast<T>(inside ? sample(kind, x0 + x, y, plane + c) : 0));
        }
      }
    };
    const auto at = static_cast<std::uint16_t>(plane);
    if (kind.tile == 0) {
      for (int y = 0; y < kHeight; ++y) {
        std::vector<T> row;
        fill(row, 0, kWidth, y);
        ASSERT_EQ(TIFFWriteScanline(tiff, row.data(), static_cast<std::uint32_t>(y), at), 1);
      }
      continue;
    }
    for (int y0 = 0; y0 < kHeight; y0 += kind.tile) {
      for (int x0 = 0; x0 < kWidth; x0 += kind.tile) {
        std::vector<T> block;
        for (int y = 0; y < kind.tile; ++y) fill(block, x0, kind.tile, y0 + y);
        ASSERT_GT(TIFFWriteTile(tiff, block.data(), static_cast<std::uint32_t>(x0),
                                static_cast<std::uint32_t>(y0), 0, at),
                  0);
      }
    }
  }
}

void write_tiff(const std::string& path, const Kind& kind, int pages = 1) {
  TIFF* tiff = TIFFOpen(path.c_str(), kind.mode);
  ASSERT_NE(tiff, nullptr);
  for (int page = 0; page < pages; ++page) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, kWidth);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, kHeight);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, kind.bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, kind.samples);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, kind.photometric);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, kind.planar);
    TIFFSetField(tiff, TIFFTAG_ORIENTATION, kind.orientation);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, kind.format);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, kind.compression);
    if (kind.predictor != 1) TIFFSetField(tiff, TIFFTAG_PREDICTOR, kind.predictor);
    if (kind.tile != 0) {
      TIFFSetField(tiff, TIFFTAG_TILEWIDTH, kind.tile);
      TIFFSetField(tiff, TIFFTAG_TILELENGTH, kind.tile);
    } else {
      TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, kind.rows_per_strip);
    }
    if (kind.photometric == PHOTOMETRIC_PALETTE) {
      std::vector<std::uint16_t> map(256);  // the reverse of the codes
      for (int i = 0; i < 256; ++i) {
        map[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>((255 - i) << 8);
      }
      TIFFSetField(tiff, TIFFTAG_COLORMAP, map.data(), map.data(), map.data());
    }
    if (kind.bits == 16) {
      write_pixels<std::uint16_t>(tiff, kind);
    } else {
      write_pixels<std::uint8_t>(tiff, kind);
    }
    TIFFWriteDirectory(tiff);
  }
  TIFFClose(tiff);
}

// The grey level that a reader must give at a place of the stored picture.
double expected(const Kind& kind, int x, int y) {
  const double full = kind.bits == 16 ? 65535 : 255;
  const double grey = sample(kind, x, y, 0);
  if (kind.photometric == PHOTOMETRIC_MINISWHITE || kind.photometric == PHOTOMETRIC_PALETTE) {
    return full - grey;
  }
  if (kind.samples < 3) return grey;
  return 0.299 * grey + 0.587 * sample(kind, x, y, 1) + 0.114 * sample(kind, x, y, 2);
}

// Grey must be exact; luminance is rounded, its weights in 16 bits.
void expect_reads_back(const Kind& kind, double tolerance) {
  const ScratchFolder folder;
  const std::string path = folder.file("a.tif");
  write_tiff(path, kind);
  const auto clip = video::open_video({path});
  ASSERT_EQ(clip->info().width, kWidth);
  ASSERT_EQ(clip->info().height, kHeight);
  ASSERT_EQ(clip->info().bits, kind.bits);
  Frame frame;
  clip->read(0, frame);
  const bool mirror =
      kind.orientation == ORIENTATION_TOPRIGHT || kind.orientation == ORIENTATION_BOTRIGHT;
  const bool turn =
      kind.orientation == ORIENTATION_BOTLEFT || kind.orientation == ORIENTATION_BOTRIGHT;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int sx = mirror ? kWidth - 1 - x : x, sy = turn ? kHeight - 1 - y : y;
      const double got = kind.bits == 16 ? frame.u16(x, y) : frame.u8(x, y);
      ASSERT_NEAR(got, expected(kind, sx, sy), tolerance) << x << ", " << y;
    }
  }
}

TEST(Tiff, ByteOrdersAndBigTiff) {
  for (const char* mode : {"w", "wl", "wb", "w8", "w8b"}) {
    SCOPED_TRACE(mode);
    expect_reads_back({.mode = mode, .bits = 8}, 0);
    expect_reads_back({.mode = mode, .bits = 16}, 0);
  }
}

TEST(Tiff, EveryLosslessCompression) {
  for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE,
                                COMPRESSION_PACKBITS, COMPRESSION_ZSTD, COMPRESSION_LZMA}) {
    if (!TIFFIsCODECConfigured(static_cast<std::uint16_t>(compression))) continue;
    SCOPED_TRACE(compression);
    expect_reads_back({.bits = 8, .compression = compression}, 0);
    expect_reads_back({.mode = "wb", .bits = 16, .compression = compression}, 0);
  }
  expect_reads_back({.bits = 16, .compression = COMPRESSION_LZW, .predictor = 2}, 0);
  expect_reads_back({.compression = COMPRESSION_ADOBE_DEFLATE, .predictor = 2}, 0);
}

TEST(Tiff, OneColourAlone) {
  const ScratchFolder folder;
  const std::string path = folder.file("a.tif");
  for (const int bits : {8, 16}) {
    for (const int planar : {PLANARCONFIG_CONTIG, PLANARCONFIG_SEPARATE}) {
      const Kind kind{.bits = bits, .samples = 3, .photometric = PHOTOMETRIC_RGB, .planar = planar};
      write_tiff(path, kind);
      int plane = 0;
      for (const Channel channel : {Channel::kRed, Channel::kGreen, Channel::kBlue}) {
        OpenOptions options;
        options.channel = channel;
        const auto clip = video::open_video({path}, options);
        ASSERT_EQ(clip->info().warnings.size(), 1u);
        EXPECT_NE(clip->info().warnings[0].find(to_string(channel)), std::string::npos);
        Frame frame;
        clip->read(0, frame);
        for (int x = 0; x < kWidth; ++x) {
          const int level = bits == 8 ? frame.u8(x, 5) : frame.u16(x, 5);
          ASSERT_EQ(level, sample(kind, x, 5, plane)) << bits << " " << planar << " " << x;
        }
        ++plane;
      }
    }
  }
}

TEST(Tiff, ColoursBecomeLuminance) {
  // Half a level of rounding, and the largest error of a weight of 16 bits (38470/65536 for 0.587:
  // 5.6e-6) times the full scale.
  for (const int bits : {8, 16}) {
    SCOPED_TRACE(bits);
    const double tolerance = 0.5 + 5.7e-6 * (bits == 8 ? 255 : 65535);
    const int rgb = PHOTOMETRIC_RGB, apart = PLANARCONFIG_SEPARATE;
    expect_reads_back({.bits = bits, .samples = 3, .photometric = rgb}, tolerance);
    expect_reads_back({.bits = bits, .samples = 4, .photometric = rgb}, tolerance);
    expect_reads_back({.bits = bits, .samples = 3, .photometric = rgb, .planar = apart}, tolerance);
    expect_reads_back({.bits = bits, .samples = 3, .photometric = rgb, .planar = apart, .tile = 16},
                      tolerance);
    expect_reads_back({.bits = bits, .samples = 2}, 0);  // grey and transparency
    expect_reads_back({.bits = bits, .samples = 2, .planar = apart}, 0);
  }
}

TEST(Tiff, PalettesAndReversedGrey) {
  expect_reads_back({.photometric = PHOTOMETRIC_MINISWHITE}, 0);
  expect_reads_back({.bits = 16, .photometric = PHOTOMETRIC_MINISWHITE}, 0);
  expect_reads_back({.photometric = PHOTOMETRIC_PALETTE}, 0);
}

TEST(Tiff, StripsTilesAndOrientations) {
  for (const int rows : {1, 8, kHeight, 1000}) expect_reads_back({.rows_per_strip = rows}, 0);
  expect_reads_back({.tile = 16}, 0);
  expect_reads_back({.bits = 16, .compression = COMPRESSION_LZW, .tile = 32}, 0);
  for (const int orientation : {ORIENTATION_TOPRIGHT, ORIENTATION_BOTRIGHT, ORIENTATION_BOTLEFT}) {
    expect_reads_back({.orientation = orientation}, 0);
    expect_reads_back({.bits = 16, .orientation = orientation}, 0);
  }
}

TEST(Tiff, RefusedKindsSayWhy) {
  const ScratchFolder folder;
  const auto refusal = [&](const Kind& kind) -> std::string {
    const std::string path = folder.file("a.tif");
    write_tiff(path, kind);
    try {
      video::open_video({path});
    } catch (const FormatError& error) {
      return error.line();
    }
    return "";
  };
  EXPECT_NE(refusal({.bits = 16, .format = SAMPLEFORMAT_INT}).find("unsigned"), std::string::npos);
  EXPECT_NE(refusal({.orientation = ORIENTATION_LEFTTOP}).find("side"), std::string::npos);
  EXPECT_NE(refusal({.samples = 3}).find("grey"), std::string::npos);
}

TEST(Tiff, PagesMustBeAlike) {
  const ScratchFolder folder;
  const std::string path = folder.file("a.tif");
  write_tiff(path, {}, 2);
  write_tiff(path, {.mode = "a", .bits = 16}, 1);
  const auto clip = video::open_video({path});
  ASSERT_EQ(clip->info().frame_count, 3);
  Frame frame;
  clip->read(1, frame);
  EXPECT_THROW(clip->read(2, frame), FormatError);
  clip->read(0, frame);  // the clip stays readable
}

}  // namespace
}  // namespace impactdic
