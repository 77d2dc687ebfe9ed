// Clips that are no files: pictures in the caller's memory, or made by a function.
#include <impactdic/clip.h>
#include <impactdic/error.h>

#include <algorithm>
#include <cstring>
#include <mutex>

#include "host/video/byte_file.h"

namespace impactdic {
namespace {

constexpr int kMostBits = 16;

void check_picture(const std::string& name, int width, int height, int bits) {
  constexpr std::int64_t kMostPixels = video::kMaxFrameBytes / 2;
  if (width < 1 || height < 1 || std::int64_t{width} * height > kMostPixels) {
    throw InvalidArgument(
        "no picture has " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
        name);
  }
  if (bits < 1 || bits > kMostBits) {
    throw InvalidArgument("a pixel has 1 to 16 bits, not " + std::to_string(bits), name);
  }
}

template <typename T>
bool fits(const Image<T>& picture, int bits) {
  if (bits == static_cast<int>(8 * sizeof(T))) return true;
  T all = 0;  // as whole words, compilers compare many pixels at once
  const T* const pixels = picture.data();
  for (std::size_t i = 0; i < picture.size(); ++i) all |= pixels[i];
  return all >> bits == 0;
}

class MemorySource : public FrameSource {
 public:
  explicit MemorySource(MemoryClip clip) : clip_(std::move(clip)) {
    check_picture(clip_.name, clip_.width, clip_.height, clip_.bits);
    row_bytes_ = std::ptrdiff_t{clip_.width} * (clip_.bits > 8 ? 2 : 1);
    if (clip_.pitch_bytes == 0) clip_.pitch_bytes = row_bytes_;
    if (std::abs(clip_.pitch_bytes) < row_bytes_) {
      throw InvalidArgument("rows of " + std::to_string(row_bytes_) + " bytes do not lie " +
                                std::to_string(clip_.pitch_bytes) + " bytes apart",
                            clip_.name);
    }
    if (clip_.frames.empty()) throw InvalidArgument("the clip has no frames", clip_.name);
    for (const void* frame : clip_.frames) {
      if (frame == nullptr) throw InvalidArgument("a frame is null", clip_.name);
    }
    if (!(clip_.fps >= 0)) throw InvalidArgument("the frame rate must be positive", clip_.name);
    info_.path = clip_.name;
    info_.format = "memory";
    info_.width = clip_.width;
    info_.height = clip_.height;
    info_.bits = clip_.bits;
    info_.frame_count = static_cast<std::int64_t>(clip_.frames.size());
    if (clip_.fps > 0) info_.fps = clip_.fps;
  }

  const ClipInfo& info() const override { return info_; }

  void read(std::int64_t index, Frame& frame) override {
    video::check_frame_index(info_.path, index, info_.frame_count);
    const auto* from =
        static_cast<const std::uint8_t*>(clip_.frames[static_cast<std::size_t>(index)]);
    frame.reset(0, 0, clip_.bits);
    const bool whole = frame.type == PixelType::kU8 ? show(from, frame.u8) : show(from, frame.u16);
    if (!whole) {
      throw InvalidArgument("a pixel of frame " + std::to_string(index) + " is brighter than " +
                                std::to_string(clip_.bits) + " bits allow",
                            info_.path);
    }
  }

 private:
  // False where a pixel has more bits than the clip.
  template <typename T>
  bool show(const std::uint8_t* from, Image<T>& picture) const {
    const bool aligned = reinterpret_cast<std::uintptr_t>(from) % alignof(T) == 0;
    if (clip_.pitch_bytes == row_bytes_ && aligned) {
      picture.borrow({reinterpret_cast<const T*>(from), [owner = clip_.owner](const T*) {}},
                     clip_.width, clip_.height);
    } else {
      picture.resize(clip_.width, clip_.height);
      for (int y = 0; y < clip_.height; ++y) {
        std::memcpy(picture.row(y), from + y * clip_.pitch_bytes,
                    static_cast<std::size_t>(row_bytes_));
      }
    }
    return fits(std::as_const(picture), clip_.bits);
  }

  MemoryClip clip_;
  std::ptrdiff_t row_bytes_ = 0;
  ClipInfo info_;
};

class CallbackSource : public FrameSource {
 public:
  CallbackSource(ClipInfo info, std::function<void(std::int64_t, Frame&)> read, bool one_at_a_time)
      : info_(std::move(info)), read_(std::move(read)), one_at_a_time_(one_at_a_time) {
    if (info_.path.empty()) info_.path = "memory";
    if (info_.format.empty()) info_.format = "memory";
    check_picture(info_.path, info_.width, info_.height, info_.bits);
    if (info_.frame_count < 1) throw InvalidArgument("the clip has no frames", info_.path);
    if (!read_) throw InvalidArgument("no function gives the frames", info_.path);
  }

  const ClipInfo& info() const override { return info_; }

  void read(std::int64_t index, Frame& frame) override {
    video::check_frame_index(info_.path, index, info_.frame_count);
    std::unique_lock<std::mutex> lock(mutex_, std::defer_lock);
    if (one_at_a_time_) lock.lock();
    read_(index, frame);
    const bool bytes = info_.bits <= 8;
    if (frame.width() != info_.width || frame.height() != info_.height ||
        frame.bits != info_.bits || (frame.type == PixelType::kU8) != bytes) {
      throw InvalidArgument("frame " + std::to_string(index) +
                                " has another size or depth than "
                                "the clip",
                            info_.path);
    }
  }

 private:
  ClipInfo info_;
  std::function<void(std::int64_t, Frame&)> read_;
  bool one_at_a_time_;
  std::mutex mutex_;
};

}  // namespace

std::unique_ptr<FrameSource> clip_from_memory(MemoryClip clip) {
  return std::make_unique<MemorySource>(std::move(clip));
}

std::unique_ptr<FrameSource> clip_from_callback(ClipInfo info,
                                                std::function<void(std::int64_t, Frame&)> read,
                                                bool one_at_a_time) {
  return std::make_unique<CallbackSource>(std::move(info), std::move(read), one_at_a_time);
}

}  // namespace impactdic
