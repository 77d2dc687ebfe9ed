// Which frames of a clip are analysed: --frames A:B[:STEP].
#pragma once

#include <impactdic/clip.h>

#include <cstdint>
#include <string>

namespace impactdic {

// "A:B[:STEP]", each part may be empty; B excluded. "" is the whole clip. `end` is kToTheEnd where
// B is empty. Throws InvalidArgument.
FrameRange read_frame_range(const std::string& text);
// The same back; "" for the whole clip.
std::string to_text(const FrameRange& range);

// The part of `range` that a clip of `frame_count` frames has. Throws InvalidArgument where that is
// none, or where the range itself is impossible.
FrameRange resolve(FrameRange range, std::int64_t frame_count);

// Both at once.
FrameRange parse_frame_range(const std::string& text, std::int64_t frame_count);

}  // namespace impactdic
