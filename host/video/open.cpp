// Which reader takes a clip.
#include <impactdic/error.h>
#include <impactdic/safety/sandbox.h>

#include <filesystem>

#include "host/video/codec_module.h"
#include "host/video/file_kind.h"
#include "host/video/format/readers.h"
#include "host/video/natural_order.h"
#include "host/video/picture_size.h"
#include "host/video/sandbox/codec_process.h"

namespace impactdic::video {
namespace {

std::unique_ptr<FrameSource> open_file(const std::string& path, const OpenOptions& options) {
  switch (tell_file_kind(path)) {
    case FileKind::kCine:
      return open_cine(path, options.phantom_codes, options.lend_file_memory);
    case FileKind::kMraw:
    case FileKind::kCih:
      return open_mraw(path, options.lend_file_memory);
    case FileKind::kSeq:
      return open_seq(path, options.lend_file_memory);
    case FileKind::kTiff:
      // Without the codecs there is no such process either, and who asked for it is told so.
      return has_picture_sandbox() ? sandbox::open_tiff(path, options)
                                   : open_tiff(path, options.channel);
    case FileKind::kPicture:
      return open_image_sequence({path}, options);
    case FileKind::kContainer:
      if (has_codecs() && has_sandbox()) return sandbox::open(path, options);
      return codec_module(path, "convert the clip to TIFF, or build with IMPACTDIC_CODECS")
          .open(path, options);
    case FileKind::kUnknown:
      break;
  }
  throw FormatError(path, 0, "the format is not known",
                    "headerless pixels need --raw WIDTHxHEIGHTxBITS");
}

std::unique_ptr<FrameSource> open_any(const std::vector<std::string>& inputs,
                                      const OpenOptions& options) {
  namespace fs = std::filesystem;
  if (inputs.empty()) throw InvalidArgument("no video is named");
  if (options.raw) {
    if (inputs.size() > 1) throw InvalidArgument("raw pixels come in one file", inputs[1]);
    return open_raw(inputs[0], *options.raw, options.lend_file_memory);
  }
  if (inputs.size() > 1) return open_image_sequence(inputs, options);
  const std::string& input = inputs[0];
  std::error_code not_there;  // what cannot be looked at is an error of its reader below
  if (fs::is_directory(input, not_there)) {
    return open_image_sequence(pictures_in_folder(input), options);
  }
  if (!fs::exists(input, not_there) && is_pattern(input)) {
    const auto files = files_of_pattern(input);
    return files.size() == 1 ? open_file(files[0], options) : open_image_sequence(files, options);
  }
  return open_file(input, options);
}

}  // namespace

std::unique_ptr<FrameSource> open_video(const std::vector<std::string>& inputs,
                                        const OpenOptions& options) {
  auto clip = open_any(inputs, options);
  // The codecs have looked before they decoded; the other readers have taken no memory yet.
  const ClipInfo& info = clip->info();
  check_megapixels(info.path, info.width, info.height, options.max_megapixels);
  return clip;
}

}  // namespace impactdic::video
