// Picture files, and which reader takes what.
#include <impactdic/error.h>
#include <zlib.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>

#include "host/video/byte_file.h"
#include "host/video/channel.h"
#include "host/video/codec/codec.h"
#include "host/video/codec/container.h"
#include "host/video/codec/grey.h"
#include "host/video/file_kind.h"
#include "host/video/picture_size.h"

namespace impactdic::video {
namespace {

// A cut JPEG decodes without complaint, its missing part grey: look for the end mark.
void check_jpeg_end(const ByteFile& file) {
  const auto start = file.head(2);
  if (start.size() < 2 || start[0] != 0xff || start[1] != 0xd8) return;
  const auto tail = file.head(65536, std::max<std::int64_t>(0, file.size() - 65536));
  const std::uint8_t mark[] = {0xff, 0xd9};
  if (std::search(tail.begin(), tail.end(), mark, mark + 2) == tail.end()) {
    throw FormatError(file.path(), file.size(), "the JPEG ends too early", "was it copied whole?");
  }
}

// libpng reports damage to stderr and this library prints nothing: every chunk's check sum is
// looked at first.
void check_png_chunks(const ByteFile& file) {
  constexpr std::int64_t kSignature = 8, kAround = 12;  // length, type and check sum
  if (!file.holds(0, kSignature) || file.head(1)[0] != 0x89) return;
  std::int64_t at = kSignature;
  while (true) {
    const auto head = file.bytes_at(at, 8);
    const std::int64_t length =
        std::int64_t{head[0]} << 24 | head[1] << 16 | head[2] << 8 | head[3];
    if (!file.holds(at, length + kAround)) {
      throw FormatError(file.path(), at, "the PNG ends too early", "was it copied whole?");
    }
    const auto body = file.bytes_at(at + 4, static_cast<std::size_t>(length + 8));
    const auto sum = ::crc32(0, body.data(), static_cast<uInt>(length + 4));
    const std::uint8_t* stored = body.data() + length + 4;
    if (sum != (std::uint32_t{stored[0]} << 24 | std::uint32_t{stored[1]} << 16 |
                std::uint32_t{stored[2]} << 8 | stored[3])) {
      throw FormatError(file.path(), at, "a part of the PNG is damaged (check sum)");
    }
    if (body[0] == 'I' && body[1] == 'E' && body[2] == 'N' && body[3] == 'D') return;
    at += length + kAround;
  }
}

cv::Mat load_picture(const std::string& path, double max_megapixels) {
  silence_opencv();
  const ByteFile file(path);
  const PictureSize size = picture_size(file);
  check_megapixels(path, size.width, size.height, max_megapixels);
  // OpenCV reports what is missing to stderr, and this library prints nothing.
  if (size.least_bytes > file.size()) {
    throw FormatError(path, file.size(), "the picture ends too early", "was it copied whole?");
  }
  check_png_chunks(file);
  check_jpeg_end(file);
  cv::Mat picture;
  try {
    picture = cv::imread(path, cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR);
  } catch (const cv::Exception& error) {
    throw FormatError(path, -1, "the picture cannot be decoded", error.err);
  }
  if (picture.empty()) throw FormatError(path, -1, "the picture cannot be decoded");
  return picture;
}

// One picture, decoded when it is opened.
class PictureSource : public FrameSource {
 public:
  PictureSource(const std::string& path, const OpenOptions& options) {
    const cv::Mat picture = load_picture(path, options.max_megapixels);
    to_frame(picture, path, options.channel, frame_);
    info_.path = path;
    info_.format = lower_extension(path).empty() ? "picture" : lower_extension(path).substr(1);
    info_.storage = std::to_string(frame_.bits) + "-bit";
    info_.width = frame_.width();
    info_.height = frame_.height();
    info_.bits = frame_.bits;
    info_.frame_count = 1;
    if (is_colored(picture)) info_.warnings.push_back(colour_warning(options.channel));
  }
  const ClipInfo& info() const override { return info_; }
  void read(std::int64_t index, Frame& frame) override {
    check_frame_index(info_.path, index, 1);
    frame = frame_;
  }

 private:
  ClipInfo info_;
  Frame frame_;
};

}  // namespace

std::unique_ptr<FrameSource> open_codec(const std::string& path, const OpenOptions& options) {
  if (tell_file_kind(path) == FileKind::kContainer) return open_container(path, options);
  return std::make_unique<PictureSource>(path, options);
}

}  // namespace impactdic::video
