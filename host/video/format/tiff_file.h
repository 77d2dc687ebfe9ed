// One open TIFF through libtiff, and how its pages become grey frames.
#pragma once

#include <impactdic/clip.h>
#include <impactdic/image.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host/video/byte_file.h"

struct tiff;  // libtiff's handle

namespace impactdic::video {

// What one page holds.
struct TiffPage {
  std::uint32_t width = 0, height = 0;
  std::uint16_t depth = 8;        // stored bits a sample: 8 or 16
  std::uint16_t samples = 1;      // a pixel
  std::uint16_t photometric = 1;  // TIFF's tag
  bool planar = false;            // one plane a colour
  bool tiled = false;
  bool flip_rows = false, flip_columns = false;  // orientation tag
  std::string compression, description, camera;
  Channel channel = Channel::kLuminance;  // of a picture in colour: what is decoded
};

// The file offsets of all pages, in order, by walking the chain of directories.
// Throws FormatError for a chain that leaves the file or loops.
std::vector<std::uint64_t> tiff_page_offsets(const ByteFile& file);

// Not thread-safe: one handle, one thread at a time.
class TiffFile {
 public:
  // Throws FormatError where libtiff does not take it.
  explicit TiffFile(const std::string& path, std::int64_t file_size);
  ~TiffFile();
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;

  // Goes to the page at this offset and says what it holds. Throws FormatError for a kind of
  // picture that is not supported.
  TiffPage go_to(std::uint64_t offset);
  // Decodes the current page as grey: of colour what TiffPage::channel says.
  void decode(const TiffPage& page, Frame& frame);

 private:
  std::string path_;
  std::int64_t file_size_;
  std::string error_;  // libtiff's last message
  std::shared_ptr<tiff> handle_;
  std::vector<std::uint8_t> rows_;
};

}  // namespace impactdic::video
