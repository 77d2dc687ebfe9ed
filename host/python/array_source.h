// Frames that lie in an array: any strides, shown without a copy where rows have no gaps.
#pragma once

#include <impactdic/clip.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace impactdic::python {

struct ArrayFrames {
  int width = 0, height = 0;
  int bits = 8;                     // effective; up to 8 a pixel is one byte, above two
  int item_bytes = 1;               // of a pixel in the array
  std::vector<const void*> frames;  // first pixel of each
  std::ptrdiff_t row_bytes = 0, pixel_bytes = 0;  // strides, of either sign
  double fps = 0;                                 // 0: not known
  // The array is a file that the system maps: what was measured need not stay in memory.
  bool release_pages = false;
  std::shared_ptr<const void> owner;
};

// Throws InvalidArgument as clip_from_memory does.
std::shared_ptr<FrameSource> array_source(ArrayFrames frames);

}  // namespace impactdic::python
