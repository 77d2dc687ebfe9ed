// Several picture files as one clip: TIFF through libtiff, other kinds through the codecs.
#include <impactdic/error.h>
#include <impactdic/safety/sandbox.h>

#include <filesystem>

#include "host/video/byte_file.h"
#include "host/video/codec_module.h"
#include "host/video/file_kind.h"
#include "host/video/format/readers.h"
#include "host/video/sandbox/codec_process.h"

namespace impactdic::video {
namespace {

std::unique_ptr<FrameSource> open_picture(const std::string& path, const OpenOptions& options) {
  const FileKind kind = tell_file_kind(path);
  if (kind == FileKind::kTiff) return open_tiff(path);
  if (kind != FileKind::kPicture) {
    throw InvalidArgument("not a picture file", path,
                          "several files form a sequence only if all are pictures");
  }
  return codec_module(path, "only TIFF pictures are read").open(path, options);
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
  }

  const ClipInfo& info() const override { return info_; }

  void read(std::int64_t index, Frame& frame) override {
    check_frame_index(info_.path, index, info_.frame_count);
    const std::string& path = paths_[static_cast<std::size_t>(index)];
    const auto picture = open_picture(path, options_);
    const ClipInfo& its = picture->info();
    if (its.width != info_.width || its.height != info_.height || its.bits != info_.bits) {
      throw FormatError(path, -1,
                        "a picture of " + std::to_string(its.width) + " x " +
                            std::to_string(its.height) + " at " + std::to_string(its.bits) +
                            " bits among those of " + std::to_string(info_.width) + " x " +
                            std::to_string(info_.height) + " at " + std::to_string(info_.bits),
                        "frames of a clip must be alike");
    }
    picture->read(0, frame);
  }

 private:
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
