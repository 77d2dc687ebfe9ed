#include "host/video/unpack.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "host/video/byte_file.h"

namespace impactdic::video {
namespace {

// All bits that occur in any of the values.
std::uint16_t or_of_all(const std::uint16_t* values, std::size_t count) {
  std::uint16_t all = 0;
  for (std::size_t i = 0; i < count; ++i) all = static_cast<std::uint16_t>(all | values[i]);
  return all;
}

}  // namespace

int stored_bits(Packing packing) {
  switch (packing) {
    case Packing::kU8:
      return 8;
    case Packing::kU16:
      return 16;
    case Packing::kPacked10:
      return 10;
    case Packing::kPacked12:
      return 12;
  }
  return 8;
}

const char* packing_name(Packing packing) {
  switch (packing) {
    case Packing::kU8:
      return "8-bit";
    case Packing::kU16:
      return "16-bit little-endian";
    case Packing::kPacked10:
      return "10-bit packed";
    case Packing::kPacked12:
      return "12-bit packed";
  }
  return "";
}

std::int64_t packed_bytes(Packing packing, std::int64_t pixels) {
  return (pixels * stored_bits(packing) + 7) / 8;
}

void unpack_10(const std::uint8_t* in, std::size_t count, std::uint16_t* out) {
  const std::size_t groups = count / 4;
  for (std::size_t g = 0; g < groups; ++g) {
    const std::uint8_t* b = in + 5 * g;
    std::uint16_t* p = out + 4 * g;
    p[0] = static_cast<std::uint16_t>(b[0] << 2 | b[1] >> 6);
    p[1] = static_cast<std::uint16_t>((b[1] & 0x3f) << 4 | b[2] >> 4);
    p[2] = static_cast<std::uint16_t>((b[2] & 0x0f) << 6 | b[3] >> 2);
    p[3] = static_cast<std::uint16_t>((b[3] & 0x03) << 8 | b[4]);
  }
  const std::uint8_t* b = in + 5 * groups;
  for (std::size_t i = 4 * groups; i < count; ++i) {  // the last, incomplete group
    const std::size_t k = i % 4;
    out[i] = static_cast<std::uint16_t>(((b[k] << 8 | b[k + 1]) >> (6 - 2 * k)) & 0x3ff);
  }
}

void unpack_12(const std::uint8_t* in, std::size_t count, std::uint16_t* out) {
  const std::size_t pairs = count / 2;
  for (std::size_t g = 0; g < pairs; ++g) {
    const std::uint8_t* b = in + 3 * g;
    out[2 * g] = static_cast<std::uint16_t>(b[0] << 4 | b[1] >> 4);
    out[2 * g + 1] = static_cast<std::uint16_t>((b[1] & 0x0f) << 8 | b[2]);
  }
  if (count % 2 != 0) {
    const std::uint8_t* b = in + 3 * pairs;
    out[count - 1] = static_cast<std::uint16_t>(b[0] << 4 | b[1] >> 4);
  }
}

void unpack_16(const std::uint8_t* in, std::size_t count, std::uint16_t* out) {
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(out, in, 2 * count);
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      out[i] = static_cast<std::uint16_t>(in[2 * i] | in[2 * i + 1] << 8);
    }
  }
}

void shift_right(std::uint16_t* values, std::size_t count, int shift) {
  if (shift == 0) return;
  for (std::size_t i = 0; i < count; ++i) {
    values[i] = static_cast<std::uint16_t>(values[i] >> shift);
  }
}

void pack_10(const std::uint16_t* in, std::size_t count, std::uint8_t* out) {
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4, out += 5) {
    const std::uint16_t* p = in + i;
    out[0] = static_cast<std::uint8_t>(p[0] >> 2);
    out[1] = static_cast<std::uint8_t>(p[0] << 6 | p[1] >> 4);
    out[2] = static_cast<std::uint8_t>(p[1] << 4 | p[2] >> 6);
    out[3] = static_cast<std::uint8_t>(p[2] << 2 | p[3] >> 8);
    out[4] = static_cast<std::uint8_t>(p[3]);
  }
  if (i == count) return;
  std::uint16_t rest[4] = {0, 0, 0, 0};
  std::copy(in + i, in + count, rest);
  std::uint8_t group[5];
  pack_10(rest, 4, group);
  std::copy(group, group + packed_bytes(Packing::kPacked10, static_cast<std::int64_t>(count - i)),
            out);
}

void pack_12(const std::uint16_t* in, std::size_t count, std::uint8_t* out) {
  const std::size_t pairs = count / 2;
  for (std::size_t g = 0; g < pairs; ++g) {
    out[3 * g] = static_cast<std::uint8_t>(in[2 * g] >> 4);
    out[3 * g + 1] = static_cast<std::uint8_t>(in[2 * g] << 4 | in[2 * g + 1] >> 8);
    out[3 * g + 2] = static_cast<std::uint8_t>(in[2 * g + 1]);
  }
  if (count % 2 != 0) {
    out[3 * pairs] = static_cast<std::uint8_t>(in[count - 1] >> 4);
    out[3 * pairs + 1] = static_cast<std::uint8_t>(in[count - 1] << 4);
  }
}

void pack_16(const std::uint16_t* in, std::size_t count, std::uint8_t* out) {
  for (std::size_t i = 0; i < count; ++i) {
    out[2 * i] = static_cast<std::uint8_t>(in[i]);
    out[2 * i + 1] = static_cast<std::uint8_t>(in[i] >> 8);
  }
}

template <typename T>
void flip_rows(Image<T>& image) {
  for (int top = 0, bottom = image.height() - 1; top < bottom; ++top, --bottom) {
    std::swap_ranges(image.row(top), image.row(top) + image.width(), image.row(bottom));
  }
}
template void flip_rows(Image<std::uint8_t>&);
template void flip_rows(Image<std::uint16_t>&);

bool unpack_frame(Packing packing, const std::uint8_t* in, int width, int height, int bits,
                  int shift, Frame& frame) {
  frame.reset(width, height, packing == Packing::kU8 ? std::min(bits, 8) : bits);
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (packing == Packing::kU8) {
    std::memcpy(frame.u8.data(), in, count);
    return true;
  }
  // Wide storage of few bits is narrowed: the frame's type follows its effective bits.
  Image<std::uint16_t> wide;
  std::uint16_t* out = frame.u16.data();
  if (frame.type == PixelType::kU8) {
    wide.resize(width, height);
    out = wide.data();
  }
  switch (packing) {
    case Packing::kPacked10:
      unpack_10(in, count, out);
      break;
    case Packing::kPacked12:
      unpack_12(in, count, out);
      break;
    default:
      unpack_16(in, count, out);
      break;
  }
  shift_right(out, count, shift);
  const bool fits = bits >= stored_bits(packing) || or_of_all(out, count) >> bits == 0;
  if (frame.type == PixelType::kU8) {
    std::transform(out, out + count, frame.u8.data(),
                   [](std::uint16_t v) { return static_cast<std::uint8_t>(v); });
  }
  return fits;
}

bool read_frame(const ByteFile& file, std::int64_t offset, std::size_t bytes, Packing packing,
                int width, int height, int bits, int shift, bool bottom_up, Frame& frame) {
  bool fits = true;
  if (packing == Packing::kU8) {
    // Rows that have to change places are copied anyway.
    auto lent = bottom_up ? nullptr : file.lend(offset, bytes);
    frame.reset(0, 0, 8);
    if (lent) {
      frame.u8.borrow(std::move(lent), width, height);
      return true;
    }
    frame.u8.resize(width, height);
    file.read_at(offset, frame.u8.data(), bytes);
  } else {
    thread_local std::vector<std::uint8_t> stored;
    stored.resize(bytes);
    file.read_at(offset, stored.data(), bytes);
    fits = unpack_frame(packing, stored.data(), width, height, bits, shift, frame);
  }
  if (!bottom_up) return fits;
  if (frame.type == PixelType::kU8) {
    flip_rows(frame.u8);
  } else {
    flip_rows(frame.u16);
  }
  return fits;
}

}  // namespace impactdic::video
