#include "host/video/format/cine_header.h"

#include <impactdic/error.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace impactdic::video {
namespace {

constexpr std::size_t kFileHeaderBytes = 44, kBitmapHeaderBytes = 40, kSetupBytes = 13484;
constexpr std::uint32_t kPacked10 = 256, kPacked12 = 1024;

// SETUP as far as the file holds it: a field exists only if it ends at or before Length.
class Setup {
 public:
  Setup(const ByteFile& file, std::int64_t offset, std::vector<std::string>& warnings) {
    if (offset == 0) {
      warnings.push_back("no SETUP block: frame rate, exposure and camera are unknown");
      return;
    }
    const auto start = file.bytes_at(offset, 144);
    if (start[140] != 'S' || start[141] != 'T') {
      throw FormatError(file.path(), offset + 140, "the SETUP block has no \"ST\" mark");
    }
    length_ = load_u16(&start[142]);
    if (length_ < 144) throw FormatError(file.path(), offset + 142, "SETUP is shorter than 144");
    bytes_ = file.bytes_at(offset, std::min(length_, kSetupBytes));
  }

  std::size_t length() const { return length_; }
  bool has(std::size_t at, std::size_t size) const { return at + size <= bytes_.size(); }
  std::optional<std::uint16_t> u16(std::size_t at) const {
    return has(at, 2) ? std::optional(load_u16(&bytes_[at])) : std::nullopt;
  }
  std::optional<std::uint32_t> u32(std::size_t at) const {
    return has(at, 4) ? std::optional(load_u32(&bytes_[at])) : std::nullopt;
  }
  std::optional<std::int32_t> i32(std::size_t at) const {
    return has(at, 4) ? std::optional(load_i32(&bytes_[at])) : std::nullopt;
  }
  std::optional<double> f64(std::size_t at) const {
    return has(at, 8) ? std::optional(std::bit_cast<double>(load_u64(&bytes_[at]))) : std::nullopt;
  }
  std::string text(std::size_t at, std::size_t size) const {
    std::string value;
    if (!has(at, size)) return value;
    for (std::size_t i = at; i < at + size && bytes_[i] != 0; ++i) {
      if (bytes_[i] >= 32 && bytes_[i] < 127) value += static_cast<char>(bytes_[i]);
    }
    return value;
  }

 private:
  std::size_t length_ = 0;
  std::vector<std::uint8_t> bytes_;
};

// The rate of the recording, from the best field that is there.
std::optional<double> frame_rate(const Setup& setup, std::vector<std::string>& warnings) {
  const auto whole = setup.u32(768);
  const auto exact = setup.f64(13472);
  if (exact && std::isfinite(*exact) && *exact > 0 &&
      (!whole || *whole == 0 || std::abs(*exact - *whole) <= 1)) {
    return *exact;
  }
  if (whole && *whole > 0) return *whole;
  const auto narrow = setup.u16(0);
  if (!whole && narrow && *narrow > 0) {
    warnings.push_back("the frame rate comes from a 16-bit field, which wraps above 65535 1/s");
    return *narrow;
  }
  return std::nullopt;
}

std::optional<double> exposure(const Setup& setup) {
  if (const auto ns = setup.u32(1568); ns && *ns > 0) return *ns * 1e-9;
  if (const auto us = setup.u32(772); us && *us > 0) return *us * 1e-6;
  return std::nullopt;
}

// Effective bits of 16-bit storage: RealBPP, else the bitmap's number of grey levels.
int effective_bits(const Setup& setup, std::uint32_t levels, std::vector<std::string>& warnings) {
  const std::uint32_t real = setup.u32(896).value_or(0);
  if (real > 8 && real <= 16) return static_cast<int>(real);
  if (real != 0) {
    warnings.push_back("a depth of " + std::to_string(real) + " bits in 16-bit storage: ignored");
  }
  if (std::has_single_bit(levels) && levels > 256 && levels <= 65536) {
    return std::countr_zero(levels);
  }
  return 16;
}

void read_setup_facts(const Setup& setup, CineHeader& header) {
  header.fps = frame_rate(setup, header.warnings);
  header.exposure_s = exposure(setup);
  header.serial = setup.u32(743);
  header.camera_version = setup.u32(792);
  header.post_trigger = setup.u32(780);
  header.black_level = setup.i32(5732);
  header.white_level = setup.i32(5736);
  header.model = setup.text(12432, 1024);
  if (setup.i32(760).value_or(0) == 1) header.bottom_up = !header.bottom_up;
  if (setup.i32(756).value_or(0) == 1) {
    header.warnings.push_back("the camera notes a horizontal flip: pixels are given as stored");
  }
}

// Picture format: BITMAPINFOHEADER, and what SETUP adds to it.
void read_format(const ByteFile& file, std::int64_t at, const Setup& setup, int compression,
                 CineHeader& header) {
  const std::string& path = file.path();
  const auto bitmap = file.bytes_at(at, kBitmapHeaderBytes);
  const std::int64_t width = load_i32(&bitmap[4]), height = load_i32(&bitmap[8]);
  const int depth = load_u16(&bitmap[14]);
  const std::uint32_t packing = load_u32(&bitmap[16]);
  if (setup.u32(808).value_or(0) != 0 || depth == 24 || depth == 48 || compression == 2) {
    throw FormatError(path, -1, "a colour cine: only monochrome is read",
                      "convert it to grey with the camera's software");
  }
  if (compression == 1) throw FormatError(path, 4, "a JPEG-compressed cine is not supported");
  check_frame_size(path, width, height, 2);
  header.width = static_cast<int>(width);
  header.height = static_cast<int>(height);
  if (packing == kPacked10 || packing == kPacked12) {
    header.packing = packing == kPacked10 ? Packing::kPacked10 : Packing::kPacked12;
    header.bits = stored_bits(header.packing);
    header.bottom_up = false;
  } else if (packing == 0 && depth == 8) {
    header.packing = Packing::kU8;
  } else if (packing == 0 && depth == 16) {
    header.packing = Packing::kU16;
    header.bits = effective_bits(setup, load_u32(&bitmap[36]), header.warnings);
  } else {
    throw FormatError(path, at + 14,
                      "unknown pixels: " + std::to_string(depth) + " bits, compression " +
                          std::to_string(packing));
  }
  header.frame_bytes = packed_bytes(header.packing, width * height);
  const std::uint32_t stated = load_u32(&bitmap[20]);
  if (stated != 0 && stated != header.frame_bytes) {
    throw FormatError(path, at + 20,
                      "an image of " + std::to_string(stated) + " bytes where " +
                          std::to_string(header.frame_bytes) + " are expected");
  }
}

// Tagged blocks lie between SETUP and the frame table; unknown types are passed over.
void find_blocks(const ByteFile& file, std::int64_t from, CineHeader& header) {
  std::int64_t at = from;
  for (int blocks = 0; blocks < 10000 && at + 8 <= header.offset_table; ++blocks) {
    const auto head = file.bytes_at(at, 8);
    const std::int64_t size = load_u32(head.data());
    const int type = load_u16(&head[4]);
    if (size < 8 || size > header.offset_table - at) return;
    if (type == 1002) header.times = CineBlock{at + 8, (size - 8) / 8};
    if (type == 1003) header.exposures = CineBlock{at + 8, (size - 8) / 4};
    at += size;
  }
}

// Every frame must lie in the file. Also tells whether frames carry an annotation: some writers
// leave it out, and then the frames follow each other without a gap.
void check_frame_table(const ByteFile& file, CineHeader& header) {
  constexpr std::int64_t kChunk = 8192;
  const std::int64_t count = header.frame_count, bytes = header.frame_bytes;
  if (!file.holds(header.offset_table, 8 * count)) {
    throw FormatError(file.path(), header.offset_table,
                      "the table of " + std::to_string(count) + " frames is not in the file",
                      "the header is damaged or the file was cut");
  }
  const auto first = file.bytes_at(header.offset_table, 8 * std::min<std::int64_t>(count, 2));
  const std::int64_t at = load_i64(first.data());
  const std::int64_t next = count > 1 ? load_i64(&first[8]) : file.size();
  const bool no_gap = file.holds(at, bytes) && next == at + bytes;
  header.annotated = !no_gap;
  const std::int64_t least = bytes + (header.annotated ? 8 : 0);
  for (std::int64_t start = 0; start < count; start += kChunk) {
    const std::int64_t here = std::min(kChunk, count - start);
    const auto table = file.bytes_at(header.offset_table + 8 * start, 8 * here);
    for (std::int64_t i = 0; i < here; ++i) {
      const std::int64_t offset = load_i64(&table[8 * i]);
      if (offset >= static_cast<std::int64_t>(kFileHeaderBytes) && file.holds(offset, least)) {
        continue;
      }
      throw FormatError(file.path(), header.offset_table + 8 * (start + i),
                        "frame " + std::to_string(start + i) + " of " + std::to_string(count) +
                            " is not in the file",
                        "the header is damaged or the file was cut");
    }
  }
}

}  // namespace

CineHeader read_cine_header(const ByteFile& file) {
  const std::string& path = file.path();
  const auto head = file.bytes_at(0, kFileHeaderBytes);
  CineHeader header;
  if (head[0] == 0 && head[1] == 0 && load_u16(&head[2]) == kFileHeaderBytes) {
    header.warnings.push_back("the \"CI\" mark is missing");
  } else if (head[0] != 'C' || head[1] != 'I') {
    throw FormatError(path, 0, "not a cine file: no \"CI\" mark");
  }
  if (const int version = load_u16(&head[6]); version > 1) {
    header.warnings.push_back("cine version " + std::to_string(version) + ", known is 1");
  }
  header.recorded_frames = load_u32(&head[12]);
  header.first_frame_number = load_i32(&head[16]);
  header.frame_count = load_u32(&head[20]);
  header.offset_table = load_u32(&head[32]);
  header.trigger_time = load_u64(&head[36]);
  if (header.frame_count == 0) throw FormatError(path, 20, "the file holds no frames");

  const std::int64_t setup_offset = load_u32(&head[28]);
  const Setup setup(file, setup_offset, header.warnings);
  read_format(file, load_u32(&head[24]), setup, load_u16(&head[4]), header);
  read_setup_facts(setup, header);
  check_frame_table(file, header);
  if (setup_offset != 0) {
    find_blocks(file, setup_offset + static_cast<std::int64_t>(setup.length()), header);
  }
  return header;
}

}  // namespace impactdic::video
