// Several picture files as one clip: TIFF through libtiff, other kinds through the codecs. Pictures
// of different sizes, as crops are, share a canvas.
#include <impactdic/error.h>
#include <impactdic/safety/sandbox.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "host/video/byte_file.h"
#include "host/video/codec_module.h"
#include "host/video/file_kind.h"
#include "host/video/format/readers.h"
#include "host/video/picture_size.h"
#include "host/video/sandbox/codec_process.h"

namespace impactdic::video {
namespace {

std::unique_ptr<FrameSource> open_picture(const std::string& path, const OpenOptions& options) {
  const FileKind kind = tell_file_kind(path);
  if (kind == FileKind::kTiff) return open_tiff(path, options.channel);
  if (kind != FileKind::kPicture) {
    throw InvalidArgument("not a picture file", path,
                          "several files form a sequence only if all are pictures");
  }
  return codec_module(path, "only TIFF pictures are read").open(path, options);
}

// By the header alone. nullopt of a picture that is damaged: reading it says so, after those before
// it are measured.
std::optional<PictureSize> size_in_header(const std::string& path) {
  try {
    if (tell_file_kind(path) != FileKind::kTiff) return picture_size(ByteFile(path));
    const auto tiff = open_tiff(path);
    return PictureSize{tiff->info().width, tiff->info().height};
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::string to_text(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

// Median grey level along the border of a picture.
template <typename T>
T border_level(const Image<T>& picture) {
  std::vector<T> levels;
  for (int y = 0; y < picture.height(); ++y) {
    const T* row = picture.row(y);
    if (y == 0 || y == picture.height() - 1) {
      levels.insert(levels.end(), row, row + picture.width());
    } else {
      levels.push_back(row[0]);
      levels.push_back(row[picture.width() - 1]);
    }
  }
  const auto middle = levels.begin() + static_cast<std::ptrdiff_t>(levels.size() / 2);
  std::nth_element(levels.begin(), middle, levels.end());
  return *middle;
}

// The picture at the top left of a larger one, so that its coordinates stay; about it its own
// border's grey level, so that no edge is added where the background is even.
template <typename T>
void put_on_canvas(Image<T>& picture, int width, int height) {
  Image<T> canvas(width, height, border_level<T>(picture));
  for (int y = 0; y < picture.height(); ++y) {
    std::copy_n(std::as_const(picture).row(y), picture.width(), canvas.row(y));
  }
  picture = std::move(canvas);
}

class ImageSequence : public FrameSource {
 public:
  ImageSequence(const std::vector<std::string>& paths, const OpenOptions& options)
      : paths_(paths), options_(options) {
    info_ = open_picture(paths_.front(), options_)->info();
    info_.format += " sequence";
    info_.files = paths_;
    info_.frame_count = static_cast<std::int64_t>(paths_.size());
    info_.extra.emplace_back("last_file", paths_.back());
    take_canvas();
  }

  const ClipInfo& info() const override { return info_; }

  void read(std::int64_t index, Frame& frame) override {
    check_frame_index(info_.path, index, info_.frame_count);
    const std::string& path = paths_[static_cast<std::size_t>(index)];
    const auto picture = open_picture(path, options_);
    const ClipInfo& its = picture->info();
    const bool fits = info_.sizes_differ ? its.width <= info_.width && its.height <= info_.height
                                         : its.width == info_.width && its.height == info_.height;
    if (!fits || its.bits != info_.bits) {
      throw FormatError(path, -1,
                        "a picture of " + to_text(its.width, its.height) + " at " +
                            std::to_string(its.bits) + " bits among those of " +
                            to_text(info_.width, info_.height) + " at " +
                            std::to_string(info_.bits),
                        "frames of a clip must be alike");
    }
    picture->read(0, frame);
    if (its.width == info_.width && its.height == info_.height) return;
    if (frame.type == PixelType::kU8) {
      put_on_canvas(frame.u8, info_.width, info_.height);
    } else {
      put_on_canvas(frame.u16, info_.width, info_.height);
    }
  }

 private:
  // As large as the largest picture, where their headers say different sizes.
  void take_canvas() {
    const auto first = size_in_header(paths_.front());
    if (!first) return;
    PictureSize least = *first, most = *first;
    for (const std::string& path : paths_) {
      const auto size = size_in_header(path);
      if (!size) continue;
      least = {std::min(least.width, size->width), std::min(least.height, size->height)};
      most = {std::max(most.width, size->width), std::max(most.height, size->height)};
    }
    if (least.width == most.width && least.height == most.height) return;
    check_megapixels(info_.path, most.width, most.height, options_.max_megapixels);
    info_.sizes_differ = true;
    info_.width = static_cast<int>(most.width);
    info_.height = static_cast<int>(most.height);
    info_.warnings.push_back(
        "pictures of different sizes, " + to_text(least.width, least.height) + " to " +
        to_text(most.width, most.height) +
        " px: each is taken at the top left of the largest; positions hold within a picture, not "
        "from one to the next");
  }

  std::vector<std::string> paths_;
  OpenOptions options_;
  ClipInfo info_;
};

}  // namespace

std::unique_ptr<FrameSource> open_image_sequence(const std::vector<std::string>& paths,
                                                 const OpenOptions& options) {
  for (const std::string& path : paths) {
    if (!std::filesystem::exists(path)) throw FileError("there is no such file", path);
  }
  if (has_picture_sandbox()) return sandbox::open_pictures(paths, options);
  return std::make_unique<ImageSequence>(paths, options);
}

}  // namespace impactdic::video
