// Which frames of a clip are analysed: --frames A:B[:STEP].
#pragma once

#include <cstdint>
#include <string>

namespace impactdic {

// Frames first, first + step, … below end.
struct FrameRange {
  std::int64_t first = 0, end = 0, step = 1;
  std::int64_t count() const { return end > first ? (end - first + step - 1) / step : 0; }
  std::int64_t at(std::int64_t index) const { return first + index * step; }
};

// "A:B[:STEP]", each part may be empty; B excluded. "" is the whole clip. Throws InvalidArgument
// where it holds no frame of a clip of `frame_count` frames.
FrameRange parse_frame_range(const std::string& text, std::int64_t frame_count);

}  // namespace impactdic
