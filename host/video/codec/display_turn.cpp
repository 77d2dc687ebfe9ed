#include "host/video/codec/display_turn.h"

#include <cstdint>
#include <string_view>

namespace impactdic::video {
namespace {

std::uint32_t big_u32(const std::uint8_t* p) {
  return std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 | std::uint32_t{p[2]} << 8 | p[3];
}

// A box's contents: [begin, end) of the file.
struct Box {
  std::int64_t begin = 0, end = 0;
};

// Calls use(type, contents) for each box in `all`, until it answers true.
template <typename Use>
bool any_box(const ByteFile& file, const Box& all, const Use& use) {
  for (std::int64_t at = all.begin; at + 8 <= all.end && file.holds(at, 8);) {
    const auto head = file.bytes_at(at, 8);
    std::int64_t size = big_u32(head.data()), header = 8;
    if (size == 0) size = all.end - at;
    if (size == 1) {
      if (!file.holds(at + 8, 8)) return false;
      const auto large = file.bytes_at(at + 8, 8);
      size = static_cast<std::int64_t>(std::uint64_t{big_u32(large.data())} << 32 |
                                       big_u32(large.data() + 4));
      header = 16;
    }
    if (size < header || size > all.end - at) return false;
    const std::string_view type(reinterpret_cast<const char*>(head.data()) + 4, 4);
    if (use(type, Box{at + header, at + size})) return true;
    at += size;
  }
  return false;
}

bool shows_pictures(const ByteFile& file, const Box& track) {
  return any_box(file, track, [&](std::string_view type, const Box& media) {
    return type == "mdia" && any_box(file, media, [&](std::string_view inner, const Box& handler) {
             if (inner != "hdlr" || handler.end - handler.begin < 12) return false;
             const auto name = file.bytes_at(handler.begin + 8, 4);
             return std::string_view(reinterpret_cast<const char*>(name.data()), 4) == "vide";
           });
  });
}

// From a track header: a picture's x' = a x + c y, y' = b x + d y, in 16.16 bits.
std::optional<int> turns_of(const ByteFile& file, const Box& header) {
  constexpr std::int64_t kMatrix = 40, kMatrixOfVersion1 = 52;
  if (header.end - header.begin < kMatrixOfVersion1) return std::nullopt;
  const std::int64_t at =
      header.begin + (file.bytes_at(header.begin, 1)[0] == 1 ? kMatrixOfVersion1 : kMatrix);
  if (at + 20 > header.end) return std::nullopt;
  const auto bytes = file.bytes_at(at, 20);
  const auto sign = [&](int entry) {
    const auto value = static_cast<std::int32_t>(big_u32(bytes.data() + 4 * entry));
    return value > 0 ? 1 : value < 0 ? -1 : 0;
  };
  const int a = sign(0), b = sign(1), c = sign(3), d = sign(4);
  if (a == d && b == 0 && c == 0 && a != 0) return a > 0 ? 0 : 2;
  if (b == -c && a == 0 && d == 0 && b != 0) return b > 0 ? 1 : 3;
  return std::nullopt;
}

}  // namespace

std::optional<int> display_quarter_turns(const ByteFile& file) {
  const auto head = file.head(8);
  if (head.size() < 8 ||
      std::string_view(reinterpret_cast<const char*>(head.data()) + 4, 4) != "ftyp") {
    return std::nullopt;
  }
  std::optional<int> turns;
  any_box(file, {0, file.size()}, [&](std::string_view type, const Box& movie) {
    return type == "moov" && any_box(file, movie, [&](std::string_view inner, const Box& track) {
             if (inner != "trak" || !shows_pictures(file, track)) return false;
             return any_box(file, track, [&](std::string_view part, const Box& header) {
               if (part == "tkhd") turns = turns_of(file, header);
               return part == "tkhd";
             });
           });
  });
  return turns;
}

}  // namespace impactdic::video
