// What stands in the head of a Phantom .cine file, read and checked.
// Layout: Vision Research, "Cine File Format"; offsets as in docs/file-formats.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/video/byte_file.h"
#include "host/video/unpack.h"

namespace impactdic::video {

// Where a tagged block's contents lie, and how many frames they cover.
struct CineBlock {
  std::int64_t offset = 0;
  std::int64_t frames = 0;
};

struct CineHeader {
  int width = 0, height = 0;
  Packing packing = Packing::kU8;
  int bits = 8;           // effective bits of a stored pixel
  bool bottom_up = true;  // the last row is stored first
  std::int64_t frame_bytes = 0;
  std::int64_t frame_count = 0;
  std::int64_t first_frame_number = 0;  // relative to the trigger
  std::int64_t recorded_frames = 0;     // in the camera, of which the file may hold a part
  std::int64_t offset_table = 0;        // i64 per frame
  bool annotated = true;                // each frame starts with its annotation
  std::uint64_t trigger_time = 0;       // seconds · 2^32 since 1970, UTC
  std::optional<CineBlock> times, exposures;

  // From SETUP; absent where the block is too short to hold the field.
  std::optional<double> fps, exposure_s;
  std::optional<std::uint32_t> serial, camera_version, post_trigger;
  std::optional<std::int32_t> black_level, white_level;
  std::string model;
  std::vector<std::string> warnings;
};

// Throws FormatError where anything contradicts the file's size or the format, and for what is
// not supported: colour, JPEG.
CineHeader read_cine_header(const ByteFile& file);

}  // namespace impactdic::video
