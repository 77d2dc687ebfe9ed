// The writers behind open_sink, one per format. Not for users of the library.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "host/video/frame_sink.h"
#include "host/video/unpack.h"

namespace impactdic::video {

std::unique_ptr<FrameSink> open_tiff_sink(const std::string& path, const ClipInfo& info);
std::unique_ptr<FrameSink> open_raw_sink(const std::string& path, const ClipInfo& info);
std::unique_ptr<FrameSink> open_cine_sink(const std::string& path, Packing packing,
                                          const ClipInfo& info);
std::unique_ptr<FrameSink> open_mraw_sink(const std::string& path, Packing packing,
                                          const ClipInfo& info);

// A file being written: it vanishes again unless finish() is reached.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void append(const void* bytes, std::size_t count);
  void append(const std::vector<std::uint8_t>& bytes) { append(bytes.data(), bytes.size()); }
  void finish();

 private:
  std::string path_;
  std::FILE* file_ = nullptr;
};

// Little-endian integers into a byte buffer.
template <typename T>
void store(std::vector<std::uint8_t>& bytes, std::size_t at, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes[at + i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
  }
}

// One frame as stored: packed, rows from top or bottom. `stored` keeps its memory.
void pack_frame(const Frame& frame, Packing packing, bool bottom_up,
                std::vector<std::uint8_t>& stored);

}  // namespace impactdic::video
