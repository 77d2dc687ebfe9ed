#include "host/video/byte_file.h"

#include <fcntl.h>
#include <impactdic/error.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <utility>

namespace impactdic::video {

// All of a file in the address space. Pages that were lent and given back leave it again, many at a
// time, so that the program's resident memory does not grow with the clip.
class ByteFile::Mapping {
 public:
  // nullptr where that cannot be done.
  static std::shared_ptr<Mapping> of(int descriptor, std::int64_t size) {
    if (size == 0) return nullptr;
    void* begin =
        ::mmap(nullptr, static_cast<std::size_t>(size), PROT_READ, MAP_SHARED, descriptor, 0);
    if (begin == MAP_FAILED) return nullptr;
    return std::make_shared<Mapping>(static_cast<std::uint8_t*>(begin),
                                     static_cast<std::size_t>(size));
  }
  Mapping(std::uint8_t* begin, std::size_t size) : begin_(begin), size_(size) {}
  ~Mapping() { ::munmap(begin_, size_); }
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;

  // Has the bytes read, so that an error of the disk shows here. nullptr where they cannot be.
  const std::uint8_t* fetch(std::size_t offset, std::size_t count) const {
#ifdef MADV_POPULATE_READ
    const std::size_t first = offset / kPage * kPage;
    const bool there = ::madvise(begin_ + first, offset + count - first, MADV_POPULATE_READ) == 0;
    return there ? begin_ + offset : nullptr;
#else
    (void)offset, (void)count;
    return nullptr;
#endif
  }
  // The bytes are no longer looked at. What of their surroundings still is comes back by itself.
  void give_back(std::size_t offset, std::size_t count) {
    constexpr std::size_t kAtOnce = std::size_t{16} << 20;
    const std::lock_guard<std::mutex> lock(mutex_);
    low_ = std::min(low_, offset);
    high_ = std::max(high_, offset + count);
    given_back_ += count;
    if (given_back_ < kAtOnce) return;
    const std::size_t first = low_ / kPage * kPage;
    ::madvise(begin_ + first, high_ - first, MADV_DONTNEED);
    low_ = size_;
    high_ = given_back_ = 0;
  }

 private:
  static inline const std::size_t kPage = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  std::uint8_t* begin_;
  std::size_t size_;
  std::mutex mutex_;
  std::size_t low_ = size_, high_ = 0, given_back_ = 0;
};

ByteFile::ByteFile(const std::string& path, bool lends) : path_(path) {
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) throw FileError("cannot open the file", path, std::strerror(errno));
  struct stat facts {};
  if (::fstat(descriptor_, &facts) != 0 || !S_ISREG(facts.st_mode)) {
    ::close(descriptor_);
    throw FileError("not a regular file", path);
  }
  size_ = facts.st_size;
  if (lends) mapping_ = Mapping::of(descriptor_, size_);
}

ByteFile::~ByteFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

ByteFile::ByteFile(ByteFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(std::exchange(other.size_, 0)),
      mapping_(std::move(other.mapping_)) {}

bool ByteFile::holds(std::int64_t offset, std::int64_t count) const {
  return offset >= 0 && count >= 0 && offset <= size_ && count <= size_ - offset;
}

void ByteFile::read_at(std::int64_t offset, void* out, std::size_t count) const {
  if (!holds(offset, static_cast<std::int64_t>(count))) {
    throw FormatError(path_, offset, "the file ends too early",
                      "it has " + std::to_string(size_) + " bytes; was it copied whole?");
  }
  auto* to = static_cast<std::uint8_t*>(out);
  while (count > 0) {
    const ssize_t got = ::pread(descriptor_, to, count, offset);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw FileError("cannot read the file", path_, std::strerror(errno));
    if (got == 0) throw FormatError(path_, offset, "the file became shorter while being read");
    to += got;
    offset += got;
    count -= static_cast<std::size_t>(got);
  }
}

std::vector<std::uint8_t> ByteFile::bytes_at(std::int64_t offset, std::size_t count) const {
  if (!holds(offset, static_cast<std::int64_t>(count))) read_at(offset, nullptr, count);
  std::vector<std::uint8_t> bytes(count);
  read_at(offset, bytes.data(), count);
  return bytes;
}

std::shared_ptr<const std::uint8_t[]> ByteFile::lend(std::int64_t offset, std::size_t count) const {
  if (!mapping_ || !holds(offset, static_cast<std::int64_t>(count))) return nullptr;
  const auto at = static_cast<std::size_t>(offset);
  const std::uint8_t* bytes = mapping_->fetch(at, count);
  if (bytes == nullptr) return nullptr;
  return {bytes,
          [mapping = mapping_, at, count](const std::uint8_t*) { mapping->give_back(at, count); }};
}

std::vector<std::uint8_t> ByteFile::head(std::size_t count, std::int64_t offset) const {
  const std::int64_t rest = std::max<std::int64_t>(0, size_ - offset);
  return bytes_at(offset, std::min<std::size_t>(count, static_cast<std::size_t>(rest)));
}

void check_frame_size(const std::string& path, std::int64_t width, std::int64_t height,
                      int bytes_per_pixel) {
  constexpr std::int64_t kMaxSide = 1 << 20;
  const std::string size = std::to_string(width) + " x " + std::to_string(height);
  if (width < 1 || height < 1) throw FormatError(path, -1, "a picture of " + size + " pixels");
  if (width > kMaxSide || height > kMaxSide || width * height > kMaxFrameBytes / bytes_per_pixel) {
    throw FormatError(path, -1, "absurd picture size " + size, "the header is damaged");
  }
}

void check_frame_index(const std::string& path, std::int64_t index, std::int64_t count) {
  if (index < 0 || index >= count) {
    throw InvalidArgument("no frame " + std::to_string(index), path,
                          "the clip holds frames 0 to " + std::to_string(count - 1));
  }
}

}  // namespace impactdic::video
