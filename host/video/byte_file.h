// A file read at given offsets: every read is checked against the file's size first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace impactdic::video {

// The largest picture that any reader accepts, decoded bytes. More is a damaged header.
inline constexpr std::int64_t kMaxFrameBytes = std::int64_t{2} << 30;

// Read-only file; `read_at` may be called from several threads at once (pread).
class ByteFile {
 public:
  // `lends`: whether `lend` may be used. Throws FileError where `path` is absent, unreadable or no
  // regular file.
  explicit ByteFile(const std::string& path, bool lends = false);
  ~ByteFile();
  ByteFile(ByteFile&& other) noexcept;
  ByteFile& operator=(ByteFile&&) = delete;
  ByteFile(const ByteFile&) = delete;
  ByteFile& operator=(const ByteFile&) = delete;

  const std::string& path() const { return path_; }
  std::int64_t size() const { return size_; }
  // True where bytes offset … offset + count − 1 are all in the file; safe for any values.
  bool holds(std::int64_t offset, std::int64_t count) const;
  // Exactly `count` bytes. Throws FormatError beyond the end, FileError where the disk fails.
  void read_at(std::int64_t offset, void* out, std::size_t count) const;
  // The same bytes where the system keeps the file, without a copy: half of the time of one, and of
  // what passes through the processor's caches. nullptr where the file does not lend, the file
  // system cannot, or the bytes cannot be read: `read_at` says why. A file must not become shorter
  // while its bytes are lent (SIGBUS): whoever asks for lending answers for that.
  std::shared_ptr<const std::uint8_t[]> lend(std::int64_t offset, std::size_t count) const;
  std::vector<std::uint8_t> bytes_at(std::int64_t offset, std::size_t count) const;
  // At most `count` bytes from `offset`, fewer at the end of the file.
  std::vector<std::uint8_t> head(std::size_t count, std::int64_t offset = 0) const;

 private:
  class Mapping;
  std::string path_;
  int descriptor_ = -1;
  std::int64_t size_ = 0;
  std::shared_ptr<Mapping> mapping_;  // nullptr: the file does not lend
};

// Throws FormatError unless 1 ≤ width, height ≤ 2^20 and the picture fits kMaxFrameBytes.
void check_frame_size(const std::string& path, std::int64_t width, std::int64_t height,
                      int bytes_per_pixel);

// Throws InvalidArgument unless 0 ≤ index < count.
void check_frame_index(const std::string& path, std::int64_t index, std::int64_t count);

// Integers of a fixed byte order from any address.
inline std::uint16_t load_u16(const std::uint8_t* p) {
  return static_cast<std::uint16_t>(p[0] | p[1] << 8);
}
inline std::uint32_t load_u32(const std::uint8_t* p) {
  return static_cast<std::uint32_t>(load_u16(p)) | static_cast<std::uint32_t>(load_u16(p + 2))
                                                       << 16;
}
inline std::uint64_t load_u64(const std::uint8_t* p) {
  return static_cast<std::uint64_t>(load_u32(p)) | static_cast<std::uint64_t>(load_u32(p + 4))
                                                       << 32;
}
inline std::int32_t load_i32(const std::uint8_t* p) {
  return static_cast<std::int32_t>(load_u32(p));
}
inline std::int64_t load_i64(const std::uint8_t* p) {
  return static_cast<std::int64_t>(load_u64(p));
}

}  // namespace impactdic::video
