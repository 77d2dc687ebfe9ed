// The readers behind open_video, one per format. Not for users of the library.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/video/frame_source.h"

namespace impactdic::video {

// `lend`: see OpenOptions::lend_file_memory.
// Each throws FileError (absent, unreadable) or FormatError (damaged, not supported).
std::unique_ptr<FrameSource> open_cine(const std::string& path, bool phantom_codes,
                                       bool lend = false);
// `path` is a .cih, .cihx or .mraw; the other file lies beside it under the same name.
std::unique_ptr<FrameSource> open_mraw(const std::string& path, bool lend = false);
std::unique_ptr<FrameSource> open_seq(const std::string& path, bool lend = false);
// Multi-page TIFF: one page, one frame.
std::unique_ptr<FrameSource> open_tiff(const std::string& path,
                                       Channel channel = Channel::kLuminance);
std::unique_ptr<FrameSource> open_raw(const std::string& path, const RawLayout& layout,
                                      bool lend = false);
// Pictures in the given order, one frame each.
std::unique_ptr<FrameSource> open_image_sequence(const std::vector<std::string>& paths,
                                                 const OpenOptions& options);

}  // namespace impactdic::video
