// Containers and pictures, decoded in a process of their own (impactdic-codecs, beside the codecs'
// module).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/video/frame_source.h"

namespace impactdic::video::sandbox {

// As the module's `open` would give it. Throws as that does, FormatError where the process ends or
// stays silent on the file, FileError where it cannot be started.
std::unique_ptr<FrameSource> open(const std::string& path, const OpenOptions& options);
// The same of pictures in the given order, as open_image_sequence gives them.
std::unique_ptr<FrameSource> open_pictures(const std::vector<std::string>& paths,
                                           const OpenOptions& options);
// The same of one TIFF, a frame a page.
std::unique_ptr<FrameSource> open_tiff(const std::string& path, const OpenOptions& options);

}  // namespace impactdic::video::sandbox
