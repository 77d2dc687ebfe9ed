// Stored pixels to grey levels and back: 8, 10 and 12 bits packed, 16 bits little-endian.
// Plain loops over byte groups, written so that compilers turn them into vector code.
#pragma once

#include <impactdic/image.h>

#include <cstddef>
#include <cstdint>

namespace impactdic::video {

class ByteFile;

// How pixels lie in a file.
enum class Packing : std::uint8_t {
  kU8,        // one byte each
  kU16,       // two bytes, little-endian
  kPacked10,  // 5 bytes hold 4 pixels, most significant bit first
  kPacked12,  // 3 bytes hold 2 pixels, most significant bit first
};

int stored_bits(Packing packing);           // 8, 16, 10, 12
const char* packing_name(Packing packing);  // "12-bit packed"
// Bytes of `pixels` pixels in a row without gaps; the last group may be incomplete.
std::int64_t packed_bytes(Packing packing, std::int64_t pixels);

// `count` pixels from `in` (packed_bytes of them) to `out`, each shifted right by `shift` bits
// (left-justified storage).
void unpack_10(const std::uint8_t* in, std::size_t count, std::uint16_t* out);
void unpack_12(const std::uint8_t* in, std::size_t count, std::uint16_t* out);
void unpack_16(const std::uint8_t* in, std::size_t count, std::uint16_t* out);
void shift_right(std::uint16_t* values, std::size_t count, int shift);

// The inverses: values above the storage's range must not occur.
void pack_10(const std::uint16_t* in, std::size_t count, std::uint8_t* out);
void pack_12(const std::uint16_t* in, std::size_t count, std::uint8_t* out);
void pack_16(const std::uint16_t* in, std::size_t count, std::uint8_t* out);

// Turns top and bottom round.
template <typename T>
void flip_rows(Image<T>& image);

// Phantom's transfer curve of packed 10-bit pixels: code 0 … 1023 to linear 12 bits
// (Vision Research, "Cine File Format", Appendix 1). Code 0 ↦ 2; codes from 1015 on are
// saturated and ↦ 4095; nine neighbouring pairs of dark codes share a value.
const std::uint16_t* phantom_linear_10();
void linearise_10(std::uint16_t* values, std::size_t count);
// The smallest code whose linear value is nearest to `value` (0 … 4095): for writing.
std::uint16_t phantom_code_10(std::uint16_t value);

// One whole frame of width × height pixels from `in`, into `frame` with `bits` effective bits.
// Sets the frame's type and size. `shift` as above. The caller has checked all sizes.
// False where a pixel is brighter than `bits` allow: the header is wrong about its depth.
bool unpack_frame(Packing packing, const std::uint8_t* in, int width, int height, int bits,
                  int shift, Frame& frame);
// The same for a frame of `bytes` bytes at `offset` of a file, whose last row comes first where it
// is `bottom_up`; one of 8-bit pixels is lent by the file where it can be. Throws what
// ByteFile::read_at does.
bool read_frame(const ByteFile& file, std::int64_t offset, std::size_t bytes, Packing packing,
                int width, int height, int bits, int shift, bool bottom_up, Frame& frame);

}  // namespace impactdic::video
