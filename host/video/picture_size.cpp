#include "host/video/picture_size.h"

#include <impactdic/error.h>

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

PictureSize size_of_bmp(const ByteFile& file) {
  const auto head = file.head(26);
  if (head.size() < 26) refuse(file, 0);
  if (load_u32(&head[14]) == 12) return {load_u16(&head[18]), load_u16(&head[20])};
  const auto side = [&](std::size_t at) {
    return std::abs(std::int64_t{static_cast<std::int32_t>(load_u32(&head[at]))});
  };
  return {side(18), side(22)};
}

// "P5", then width and height as text, with comments between.
PictureSize size_of_pgm(const ByteFile& file) {
  const auto head = file.head(4096);
  std::array<std::int64_t, 2> numbers = {0, 0};
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
  return {numbers[0], numbers[1]};
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
