#include "host/clip/frame_range.h"

#include <impactdic/error.h>

#include <algorithm>

#include "host/base/parse.h"

namespace impactdic {

FrameRange read_frame_range(const std::string& text) {
  FrameRange range{0, kToTheEnd, 1};
  if (text.empty()) return range;
  const auto parts = split(text, ':');
  if (parts.size() < 2 || parts.size() > 3) {
    throw InvalidArgument("'" + text + "' is not A:B or A:B:STEP", "--frames");
  }
  if (!parts[0].empty()) range.first = parse_int(parts[0], "--frames");
  if (!parts[1].empty()) range.end = parse_int(parts[1], "--frames");
  if (parts.size() == 3) range.step = parse_int(parts[2], "--frames");
  return range;
}

std::string to_text(const FrameRange& range) {
  std::string text;
  if (range.first != 0 || range.end != kToTheEnd || range.step != 1) {
    text = std::to_string(range.first) + ":";
  }
  if (range.end != kToTheEnd) text += std::to_string(range.end);
  if (range.step != 1) text += ":" + std::to_string(range.step);
  return text;
}

FrameRange resolve(FrameRange range, std::int64_t frame_count) {
  const std::string asked = to_text(range);
  if (range.step < 1) throw InvalidArgument("the step must be at least 1", "--frames");
  range.end = std::min(range.end, frame_count);
  if (range.first < 0 || range.count() == 0) {
    throw InvalidArgument("'" + asked + "' holds no frame", "--frames",
                          "the clip has frames 0:" + std::to_string(frame_count));
  }
  return range;
}

FrameRange parse_frame_range(const std::string& text, std::int64_t frame_count) {
  return resolve(read_frame_range(text), frame_count);
}

}  // namespace impactdic
