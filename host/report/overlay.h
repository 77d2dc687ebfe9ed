// Annotated frames: circle, trajectory of the centre and velocity arrows, as in the dissertation's
// Figs 2.10 and 3.9.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/base/image.h"
#include "host/dic/field.h"
#include "host/track/track_row.h"

namespace impactdic {

// A colour picture, (height, width, 3) bytes, blue first.
struct ColourPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bgr;
};

class OverlayPainter {
 public:
  // Arrows are `arrow_scale` times the displacement to the next frame.
  explicit OverlayPainter(double arrow_scale = 5) : arrow_scale_(arrow_scale) {}

  // Paints frame after frame; keeps the trajectory. `frame` is a cut-out whose pixel (0, 0) is
  // (origin_x, origin_y) of the picture that `row` and `windows` are measured in. Sides are
  // rounded down to even numbers, as video codecs want them.
  ColourPicture paint(const Frame& frame, int origin_x, int origin_y, const TrackRow& row,
                      std::span<const Window> windows, std::span<const WindowMotion> field,
                      int window_px);

 private:
  struct Point {
    double x, y;
  };
  double arrow_scale_;
  std::vector<Point> trajectory_;
};

}  // namespace impactdic
