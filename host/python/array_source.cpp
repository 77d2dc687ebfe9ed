#include "host/python/array_source.h"

#include <impactdic/error.h>
#include <sys/mman.h>
#include <unistd.h>

#include <utility>

namespace impactdic::python {
namespace {

// Lets the system take back the pages that lie wholly within; they are read again where they are
// wanted again. Only for shared or read-only maps of a file, whose pages are the file's own.
void release_pages(const void* data, std::size_t bytes) {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t before = (page - reinterpret_cast<std::uintptr_t>(data) % page) % page;
  if (bytes < before + page) return;
  auto* const begin = const_cast<char*>(static_cast<const char*>(data)) + before;
  ::madvise(begin, (bytes - before) / page * page, MADV_DONTNEED);
}

class ArraySource : public FrameSource {
 public:
  explicit ArraySource(ArrayFrames array) : array_(std::move(array)) {
    // The same checks and the same words as for a clip in the memory of a program.
    MemoryClip like;
    like.width = array_.width;
    like.height = array_.height;
    like.bits = array_.bits;
    like.frames = array_.frames;
    like.fps = array_.fps;
    like.name = "array";
    info_ = clip_from_memory(std::move(like))->info();
    contiguous_ = array_.pixel_bytes == array_.item_bytes &&
                  array_.row_bytes == std::ptrdiff_t{array_.width} * array_.item_bytes &&
                  (array_.item_bytes == 1) == (array_.bits <= 8);
  }

  const ClipInfo& info() const override { return info_; }

  void read(std::int64_t index, Frame& frame) override {
    if (index < 0 || index >= info_.frame_count) {
      throw InvalidArgument("there is no frame " + std::to_string(index), info_.path,
                            "it has " + std::to_string(info_.frame_count));
    }
    const void* const from = array_.frames[static_cast<std::size_t>(index)];
    frame.reset(0, 0, array_.bits);
    const bool whole = frame.type == PixelType::kU8 ? show(from, frame.u8) : show(from, frame.u16);
    if (!whole) {
      throw InvalidArgument("a pixel of frame " + std::to_string(index) + " is brighter than " +
                                std::to_string(array_.bits) + " bits allow",
                            info_.path, "give the camera's depth with bits=");
    }
  }

 private:
  template <typename T>
  bool show(const void* from, Image<T>& picture) const {
    const bool aligned = reinterpret_cast<std::uintptr_t>(from) % alignof(T) == 0;
    if (contiguous_ && aligned) {
      const std::size_t bytes = array_.release_pages ? picture_bytes() : 0;
      picture.borrow({static_cast<const T*>(from),
                      [owner = array_.owner, bytes](const T* data) {
                        if (bytes > 0) release_pages(data, bytes);
                      }},
                     array_.width, array_.height);
    } else {
      picture.resize(array_.width, array_.height);
      array_.item_bytes == 1 ? copy<std::uint8_t>(from, picture)
                             : copy<std::uint16_t>(from, picture);
      if (array_.release_pages && array_.row_bytes > 0 && array_.pixel_bytes > 0) {
        release_pages(from, static_cast<std::size_t>(array_.row_bytes) * array_.height);
      }
    }
    return fits(std::as_const(picture));
  }

  template <typename From, typename T>
  void copy(const void* from, Image<T>& picture) const {
    for (int y = 0; y < array_.height; ++y) {
      const auto* at = static_cast<const std::uint8_t*>(from) + y * array_.row_bytes;
      T* const row = picture.row(y);
      for (int x = 0; x < array_.width; ++x, at += array_.pixel_bytes) {
        From value;
        __builtin_memcpy(&value, at, sizeof(value));
        row[x] = static_cast<T>(value);
      }
    }
  }

  template <typename T>
  bool fits(const Image<T>& picture) const {
    if (array_.bits == static_cast<int>(8 * sizeof(T))) return true;
    T all = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) all |= picture.data()[i];
    return all >> array_.bits == 0;
  }

  std::size_t picture_bytes() const {
    return static_cast<std::size_t>(array_.width) * array_.height * array_.item_bytes;
  }

  ArrayFrames array_;
  ClipInfo info_;
  bool contiguous_ = false;
};

}  // namespace

std::shared_ptr<FrameSource> array_source(ArrayFrames frames) {
  return std::make_shared<ArraySource>(std::move(frames));
}

}  // namespace impactdic::python
