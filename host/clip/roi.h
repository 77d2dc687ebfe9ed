// A rectangle of the picture: --roi X,Y,W,H.
#pragma once

#include <impactdic/clip.h>

#include <string>
#include <vector>

namespace impactdic {

// "X,Y,W,H" in pixels. Throws InvalidArgument.
Roi read_roi(const std::string& text);
std::string to_text(const Roi& roi);
// Throws InvalidArgument unless the rectangle lies inside a picture of the given size and holds at
// least one pixel.
void check_roi(const Roi& roi, int image_width, int image_height);
// Both at once; "" is the whole picture.
Roi parse_roi(const std::string& text, int image_width, int image_height);

// "X,Y,X,Y,X,Y…" in pixels: at least three corners. Throws InvalidArgument.
std::vector<PointPx> read_polygon(const std::string& text);
std::string to_text(const std::vector<PointPx>& polygon);
// 1 where a pixel's centre lies in the polygon with these corners, in order; 0 elsewhere. Throws
// InvalidArgument where no pixel does, or where there are fewer than three corners.
Image<std::uint8_t> polygon_mask(const std::vector<PointPx>& corners, int image_width,
                                 int image_height);
// Both at once.
Image<std::uint8_t> parse_polygon(const std::string& text, int image_width, int image_height);

// The part of a mask in a rectangle that lies in it.
Image<std::uint8_t> cut(const Image<std::uint8_t>& mask, const Roi& roi);

// The smallest rectangle that holds all pixels of a mask that are not 0.
Roi extent(const Image<std::uint8_t>& mask);

// Copies the rectangle out of `frame` into `cut`, keeping depth; pixel (0, 0) of the cut is
// (roi.x, roi.y) of the frame.
void crop(const Frame& frame, const Roi& roi, Frame& cut);

}  // namespace impactdic
