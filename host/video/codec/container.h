// AVI, MP4, MOV and Matroska as clips.
#pragma once

#include <memory>
#include <string>

#include "host/video/frame_source.h"

namespace impactdic::video {

std::unique_ptr<FrameSource> open_container(const std::string& path, const OpenOptions& options);

}  // namespace impactdic::video
