// Which frames of a clip are analysed: --frames A:B[:STEP].
#pragma once

#include <impactdic/clip.h>

#include <cstdint>
#include <string>

namespace impactdic {

// "A:B[:STEP]", each part may be empty; B excluded. "" is the whole clip. Throws InvalidArgument
// where it holds no frame of a clip of `frame_count` frames.
FrameRange parse_frame_range(const std::string& text, std::int64_t frame_count);

}  // namespace impactdic
