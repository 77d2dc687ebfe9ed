// Headerless pixels out of a pipe.
#include <fcntl.h>
#include <impactdic/error.h>
#include <impactdic/live/track_live.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>
#include <vector>

#include "host/video/byte_file.h"
#include "host/video/format/readers.h"
#include "host/video/frame_source.h"
#include "host/video/unpack.h"

namespace impactdic {
namespace {

constexpr int kLook_ms = 50;         // how often it looks whether it is to stop
constexpr int kPipeBytes = 1 << 20;  // a burst of frames does not hold up the sender

class RawStream : public FrameStream {
 public:
  RawStream(const std::string& path, const RawLayout& layout) : packing_(raw_packing(layout.bits)) {
    video::check_raw_layout(layout);
    video::check_frame_size(path, layout.width, layout.height, 2);
    own_ = path != "-";
    descriptor_ = own_ ? ::open(path.c_str(), O_RDONLY | O_CLOEXEC) : STDIN_FILENO;
    if (descriptor_ < 0) {
      throw FileError("cannot be opened: " + std::generic_category().message(errno), path);
    }
#ifdef F_SETPIPE_SZ
    ::fcntl(descriptor_, F_SETPIPE_SZ, kPipeBytes);  // of a pipe; what it is otherwise stays
#endif
    bytes_.resize(static_cast<std::size_t>(
        video::packed_bytes(packing_, std::int64_t{layout.width} * layout.height)));
    info_.path = own_ ? path : "standard input";
    info_.format = "raw pixels";
    info_.storage = video::packing_name(packing_);
    info_.width = layout.width;
    info_.height = layout.height;
    info_.bits = layout.bits;
  }
  ~RawStream() override {
    if (own_) ::close(descriptor_);
  }
  RawStream(const RawStream&) = delete;
  RawStream& operator=(const RawStream&) = delete;

  const ClipInfo& info() const override { return info_; }
  void stop() override { stopped_ = true; }

  bool next(Frame& frame) override {
    std::size_t have = 0;
    while (have < bytes_.size()) {
      if (!wait()) return false;
      const ssize_t got = ::read(descriptor_, bytes_.data() + have, bytes_.size() - have);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) {
        throw FileError("cannot be read: " + std::generic_category().message(errno), info_.path);
      }
      if (got == 0) break;
      have += static_cast<std::size_t>(got);
    }
    if (have == 0) return false;
    if (have < bytes_.size()) {
      throw FormatError(info_.path, -1, "the stream ends within a frame",
                        std::to_string(have) + " of " + std::to_string(bytes_.size()) +
                            " bytes came: is the size right?");
    }
    video::unpack_frame(packing_, bytes_.data(), info_.width, info_.height, info_.bits, 0, frame);
    return true;
  }

 private:
  static video::Packing raw_packing(int bits) {
    switch (bits) {
      case 8:
        return video::Packing::kU8;
      case 10:
        return video::Packing::kPacked10;
      case 12:
        return video::Packing::kPacked12;
      default:
        return video::Packing::kU16;
    }
  }
  // Until there are bytes or the end; false where it is to stop.
  bool wait() const {
    pollfd look = {descriptor_, POLLIN, 0};
    while (!stopped_) {
      if (::poll(&look, 1, kLook_ms) != 0) return true;
    }
    return false;
  }

  video::Packing packing_;
  int descriptor_ = -1;
  bool own_ = false;
  std::vector<std::uint8_t> bytes_;
  ClipInfo info_;
  std::atomic<bool> stopped_ = false;
};

}  // namespace

std::shared_ptr<FrameStream> open_raw_stream(const std::string& path, const RawLayout& layout) {
  return std::make_shared<RawStream>(path, layout);
}

}  // namespace impactdic
