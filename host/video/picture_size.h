// How large a picture is, by its header alone: before anything is decoded or memory is taken.
#pragma once

#include <cstdint>

#include "host/video/byte_file.h"

namespace impactdic::video {

struct PictureSize {
  std::int64_t width = 0, height = 0;
  std::int64_t least_bytes = 0;  // that the file must have; 0: the header does not say
};

// Of a .png, .jpg, .bmp or .pgm. Throws FormatError where the header is cut off, says none, or
// names a kind of .bmp or .pgm that nobody decodes.
PictureSize picture_size(const ByteFile& file);

// Throws FormatError, naming --max-megapixels, for a picture of more than `max_megapixels`.
void check_megapixels(const std::string& path, std::int64_t width, std::int64_t height,
                      double max_megapixels);

}  // namespace impactdic::video
