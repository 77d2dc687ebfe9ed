// How a film is meant to be seen. Internal to host/video/codec.
#pragma once

#include <optional>

#include "host/video/byte_file.h"

namespace impactdic::video {

// Quarter turns clockwise, 0 … 3, by which the pictures of an MP4 or QuickTime file are turned to
// be shown, as a telephone notes how it was held (matrix of the track header, ISO/IEC 14496-12,
// 8.3.2). nullopt where the file is none, has no track of pictures, or wants them sheared or
// mirrored.
std::optional<int> display_quarter_turns(const ByteFile& file);

}  // namespace impactdic::video
