// The grey level of one pixel, of either depth. Internal to host/circle.
#pragma once

#include <cstddef>

#include "host/video/frame_source.h"

namespace impactdic::circle {

// `x`, `y` lie in the frame.
inline double level_at(const Frame& frame, int x, int y) {
  const std::size_t at = static_cast<std::size_t>(y) * frame.width() + x;
  return frame.type == PixelType::kU8 ? frame.u8.data()[at] : frame.u16.data()[at];
}

}  // namespace impactdic::circle
