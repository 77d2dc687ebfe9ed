#include "host/dic/frames/frame_slots.h"

#include <impactdic/error.h>

#include <string>

namespace impactdic::dic {

bool FrameSlots::holds(int slot) const {
  return slot >= 0 && slot < count() && filled_[static_cast<std::size_t>(slot)];
}

void FrameSlots::fill(int slot, const Frame& frame) {
  if (slot < 0 || slot >= count()) {
    throw InvalidArgument("there is no frame slot " + std::to_string(slot));
  }
  if (frame.width() < 1 || frame.height() < 1) throw InvalidArgument("the frame has no pixels");
  if (width_ == 0) {
    width_ = frame.width();
    height_ = frame.height();
  }
  if (frame.width() != width_ || frame.height() != height_) {
    throw InvalidArgument("frames of one clip must have one size");
  }
  filled_[static_cast<std::size_t>(slot)] = true;
}

void FrameSlots::check(std::span<const Window> windows) const {
  for (const Window& window : windows) {
    for (const int slot : {window.first, window.second}) {
      if (!holds(slot)) {
        throw InvalidArgument("a window names frame slot " + std::to_string(slot) +
                              ", which holds no frame");
      }
    }
  }
}

}  // namespace impactdic::dic
