// A rectangle of the picture: --roi X,Y,W,H.
#pragma once

#include <impactdic/clip.h>

#include <string>

namespace impactdic {

// "X,Y,W,H" in pixels; must lie inside a picture of the given size and hold at least one pixel.
// "" is the whole picture. Throws InvalidArgument.
Roi parse_roi(const std::string& text, int image_width, int image_height);

// 1 where a pixel's centre lies in the polygon with these corners, "X,Y,X,Y,X,Y…" in pixels, at
// least three, in order; 0 elsewhere. Throws InvalidArgument, also where no pixel does.
Image<std::uint8_t> parse_polygon(const std::string& text, int image_width, int image_height);

// The smallest rectangle that holds all pixels of a mask that are not 0.
Roi extent(const Image<std::uint8_t>& mask);

// Copies the rectangle out of `frame` into `cut`, keeping depth; pixel (0, 0) of the cut is
// (roi.x, roi.y) of the frame.
void crop(const Frame& frame, const Roi& roi, Frame& cut);

}  // namespace impactdic
