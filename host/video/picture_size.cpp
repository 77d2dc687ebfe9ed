#include "host/video/picture_size.h"

#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <string>
#include <vector>

#include "host/base/parse.h"

namespace impactdic::video {
namespace {

std::int64_t big_endian(const std::vector<std::uint8_t>& bytes, std::size_t at, int count) {
  std::int64_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
  return value;
}

[[noreturn]] void refuse(const ByteFile& file, std::int64_t at) {
  throw FormatError(file.path(), at, "the picture's header is damaged", "was it copied whole?");
}

// Segments from mark to mark until that of a frame (ITU-T T.81, B.1.1).
PictureSize size_of_jpeg(const ByteFile& file) {
  for (std::int64_t at = 2; file.holds(at, 9);) {
    const auto head = file.bytes_at(at, 9);
    if (head[0] != 0xff) refuse(file, at);
    const int mark = head[1];
    if (mark == 0xff) {  // filling
      ++at;
      continue;
    }
    const bool is_frame =
        mark >= 0xc0 && mark <= 0xcf && mark != 0xc4 && mark != 0xc8 && mark != 0xcc;
    if (is_frame) return {big_endian(head, 7, 2), big_endian(head, 5, 2)};
    const bool is_bare = mark == 0x01 || (mark >= 0xd0 && mark <= 0xd8);
    at += 2 + (is_bare ? 0 : big_endian(head, 2, 2));
  }
  refuse(file, file.size());
}

// The header of OS/2 has sides of 16 bits and no compression. Others: 0 none, 1 and 2 run lengths,
// 3 masks of bits.
PictureSize size_of_bmp(const ByteFile& file) {
  constexpr std::size_t kOld = 26, kNew = 54;
  const auto head = file.head(kNew);
  if (head.size() < kOld) refuse(file, 0);
  const bool is_old = load_u32(&head[14]) == 12;
  if (!is_old && head.size() < kNew) refuse(file, file.size());
  const auto side = [&](std::size_t at) {
    return std::abs(std::int64_t{static_cast<std::int32_t>(load_u32(&head[at]))});
  };
  PictureSize size = is_old ? PictureSize{load_u16(&head[18]), load_u16(&head[20])}
                            : PictureSize{side(18), side(22)};
  const std::size_t depth_at = is_old ? 24 : 28;
  const int bits = load_u16(&head[depth_at]);
  const std::uint32_t compression = is_old ? 0 : load_u32(&head[30]);
  constexpr std::array kDepths = {1, 4, 8, 16, 24, 32};
  if (std::find(kDepths.begin(), kDepths.end(), bits) == kDepths.end() || compression > 3) {
    refuse(file, static_cast<std::int64_t>(depth_at));
  }
  if (!is_old && bits <= 8 && load_u32(&head[46]) > 256) refuse(file, 46);  // colours
  check_frame_size(file.path(), size.width, size.height, 4);  // their product fits below
  const std::int64_t pixels_at = load_u32(&head[10]), line = (size.width * bits + 31) / 32 * 4;
  size.least_bytes = pixels_at + (compression == 1 || compression == 2 ? 0 : line * size.height);
  return size;
}

// "P5", then width, height and the brightest level as text, with comments between; one blank, the
// pixels.
PictureSize size_of_pgm(const ByteFile& file) {
  const auto head = file.head(4096);
  std::array<std::int64_t, 3> numbers = {0, 0, 0};
  std::size_t at = 2;
  for (std::int64_t& number : numbers) {
    while (at < head.size() && (std::isspace(head[at]) != 0 || head[at] == '#')) {
      if (head[at] == '#') {
        while (at < head.size() && head[at] != '\n') ++at;
      } else {
        ++at;
      }
    }
    const std::size_t begin = at;
    for (; at < head.size() && std::isdigit(head[at]) != 0 && at < begin + 10; ++at) {
      number = number * 10 + (head[at] - '0');
    }
    if (at == begin) refuse(file, static_cast<std::int64_t>(at));
  }
  const auto [width, height, brightest] = numbers;
  if (brightest < 1 || brightest > 65535) refuse(file, static_cast<std::int64_t>(at));
  check_frame_size(file.path(), width, height, 2);
  const std::int64_t pixels = width * height * (brightest > 255 ? 2 : 1);
  return {width, height, static_cast<std::int64_t>(at) + 1 + pixels};
}

}  // namespace

PictureSize picture_size(const ByteFile& file) {
  const auto head = file.head(24);
  if (head.empty() || (head[0] == 0x89 && head.size() < 24)) refuse(file, 0);
  if (head[0] == 0x89) return {big_endian(head, 16, 4), big_endian(head, 20, 4)};
  if (head[0] == 0xff) return size_of_jpeg(file);
  if (head[0] == 'B') return size_of_bmp(file);
  if (head[0] == 'P') return size_of_pgm(file);
  refuse(file, 0);
}

void check_megapixels(const std::string& path, std::int64_t width, std::int64_t height,
                      double max_megapixels) {
  check_frame_size(path, width, height, 1);
  const double megapixels = static_cast<double>(width) * static_cast<double>(height) * 1e-6;
  if (megapixels <= max_megapixels) return;
  throw FormatError(path, -1,
                    "a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                        " pixels is larger than " + shortest(max_megapixels) + " megapixels",
                    "if it is really so large, --max-megapixels takes it");
}

}  // namespace impactdic::video
