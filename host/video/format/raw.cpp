// Headerless pixels: frames one after another, nothing between them.
#include <impactdic/error.h>

#include "host/base/parse.h"
#include "host/video/byte_file.h"
#include "host/video/format/readers.h"
#include "host/video/unpack.h"

namespace impactdic::video {
namespace {

Packing packing_for(int bits) {
  switch (bits) {
    case 8:
      return Packing::kU8;
    case 10:
      return Packing::kPacked10;
    case 12:
      return Packing::kPacked12;
    case 16:
      return Packing::kU16;
    default:
      throw InvalidArgument("no raw pixels of " + std::to_string(bits) + " bits", "--raw",
                            "8, 10 (packed), 12 (packed) or 16 (little-endian)");
  }
}

class RawSource : public FrameSource {
 public:
  RawSource(const std::string& path, const RawLayout& layout, bool lend)
      : file_(path, lend), packing_(packing_for(layout.bits)) {
    check_frame_size(path, layout.width, layout.height, 2);
    frame_bytes_ = packed_bytes(packing_, std::int64_t{layout.width} * layout.height);
    info_.path = path;
    info_.format = "raw pixels";
    info_.storage = packing_name(packing_);
    info_.width = layout.width;
    info_.height = layout.height;
    info_.bits = layout.bits;
    info_.frame_count = file_.size() / frame_bytes_;
    if (info_.frame_count == 0) {
      throw FormatError(path, file_.size(), "the file is shorter than one frame",
                        "a frame has " + std::to_string(frame_bytes_) + " bytes");
    }
    if (const auto rest = file_.size() % frame_bytes_; rest != 0) {
      info_.warnings.push_back(std::to_string(rest) +
                               " bytes are left after the last frame: is the size right?");
    }
  }

  const ClipInfo& info() const override { return info_; }

  void read(std::int64_t index, Frame& frame) override {
    check_frame_index(info_.path, index, info_.frame_count);
    read_frame(file_, index * frame_bytes_, static_cast<std::size_t>(frame_bytes_), packing_,
               info_.width, info_.height, info_.bits, 0, false, frame);
  }

 private:
  ByteFile file_;
  Packing packing_;
  std::int64_t frame_bytes_ = 0;
  ClipInfo info_;
};

}  // namespace

std::string to_text(const RawLayout& layout) {
  return std::to_string(layout.width) + "x" + std::to_string(layout.height) + "x" +
         std::to_string(layout.bits);
}

void check_raw_layout(const RawLayout& layout) {
  constexpr int kMaxSide = 1 << 20;
  for (const int side : {layout.width, layout.height}) {
    if (side < 1 || side > kMaxSide) {
      throw InvalidArgument("\"" + to_text(layout) + "\" is no raw layout", "--raw",
                            "width and height from 1 to " + std::to_string(kMaxSide));
    }
  }
  packing_for(layout.bits);
}

RawLayout parse_raw_layout(const std::string& text) {
  const auto parts = split(text, 'x');
  if (parts.size() != 3) {
    throw InvalidArgument("\"" + text + "\" is no raw layout", "--raw", "WIDTHxHEIGHTxBITS");
  }
  int numbers[3];
  for (int i = 0; i < 3; ++i) {
    const std::int64_t number = parse_int(parts[static_cast<std::size_t>(i)], "--raw");
    numbers[i] = static_cast<int>(std::clamp<std::int64_t>(number, 0, 1 << 30));
  }
  const RawLayout layout{numbers[0], numbers[1], numbers[2]};
  check_raw_layout(layout);
  return layout;
}

std::unique_ptr<FrameSource> open_raw(const std::string& path, const RawLayout& layout, bool lend) {
  return std::make_unique<RawSource>(path, layout, lend);
}

}  // namespace impactdic::video
