// A rectangle of the picture: --roi X,Y,W,H.
#pragma once

#include <string>

#include "host/base/image.h"

namespace impactdic {

struct Roi {
  int x = 0, y = 0, width = 0, height = 0;
};

// "X,Y,W,H" in pixels; must lie inside a picture of the given size and hold at least one pixel.
// "" is the whole picture. Throws InvalidArgument.
Roi parse_roi(const std::string& text, int image_width, int image_height);

// Copies the rectangle out of `frame` into `cut`, keeping depth; pixel (0, 0) of the cut is
// (roi.x, roi.y) of the frame.
void crop(const Frame& frame, const Roi& roi, Frame& cut);

}  // namespace impactdic
