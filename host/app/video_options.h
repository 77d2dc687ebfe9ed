// The options that say which clip is read and how, shared by the commands that take one.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "host/video/frame_source.h"

namespace impactdic::app {

struct VideoRequest {
  std::vector<std::string> inputs;
  std::string raw;
  double fps = 0;  // overrides the file's rate; 0: the file's
};

// Adds VIDEO, --raw and --fps.
void add_video_options(CLI::App& command, VideoRequest& request);
// Adds --raw and --fps alone.
void add_reading_options(CLI::App& command, VideoRequest& request);

// Opens the clip with every reader that this program has.
std::unique_ptr<FrameSource> open_requested(const VideoRequest& request);

// The rate of the stored frames: --fps, else the file's; throws InvalidArgument where neither is
// known and `needed_for` is not empty.
double resolve_fps(const VideoRequest& request, const ClipInfo& info,
                   const std::string& needed_for);

}  // namespace impactdic::app
