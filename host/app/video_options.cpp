#include "host/app/video_options.h"

#include <impactdic/error.h>

#include "host/app/command.h"
#ifdef IMPACTDIC_WITH_CODECS
#include "host/video/codec/codec.h"
#endif

namespace impactdic::app {

void add_video_options(CLI::App& command, VideoRequest& request) {
  command
      .add_option("video", request.inputs,
                  "Clip: .cine, .mraw/.cih/.cihx, .tif (multi-page), .avi/.mp4/.mov/.mkv, a folder "
                  "or quoted glob of pictures, several pictures, or raw pixels with --raw")
      ->required();
  add_reading_options(command, request);
}

void add_reading_options(CLI::App& command, VideoRequest& request) {
  command.add_option("--raw", request.raw, "WIDTHxHEIGHTxBITS: the file is bare pixels");
  command.add_option("--fps", request.fps, "Frames a second; overrides the file's own rate")
      ->check(positive_number());
}

std::unique_ptr<FrameSource> open_requested(const VideoRequest& request) {
  video::VideoOptions options;
  if (!request.raw.empty()) options.raw = video::parse_raw_layout(request.raw);
#ifdef IMPACTDIC_WITH_CODECS
  options.open_codec = video::open_codec;
#endif
  return video::open_video(request.inputs, options);
}

double resolve_fps(const VideoRequest& request, const ClipInfo& info,
                   const std::string& needed_for) {
  if (request.fps > 0) return request.fps;
  if (info.fps) return *info.fps;
  if (!needed_for.empty()) {
    throw InvalidArgument("the file does not say its frame rate, which " + needed_for + " needs",
                          info.path, "give it with --fps");
  }
  return 0;
}

}  // namespace impactdic::app
