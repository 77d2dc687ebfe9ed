// Annotated frames: circle, trajectory of the centre and velocity arrows, as in the dissertation's
// Figs 2.10 and 3.9.
#pragma once

#include <impactdic/image.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/clip/track_row.h"
#include "host/dic/field.h"

namespace impactdic::report {

// A colour picture, (height, width, 3) bytes, blue first.
struct ColourPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bgr;
};

class OverlayPainter {
 public:
  // Arrows are `arrow_scale` times the displacement to the next frame. `earlier`: rows of frames
  // that were painted by another run, for the trajectory.
  explicit OverlayPainter(double arrow_scale, int origin_x, int origin_y,
                          std::span<const TrackRow> earlier = {});

  // Paints frame after frame; keeps the trajectory. `frame` is a cut-out whose pixel (0, 0) is
  // (origin_x, origin_y) of the picture that `row` and `windows` are measured in. Sides are
  // rounded down to even numbers, as video codecs want them.
  ColourPicture paint(const Frame& frame, const TrackRow& row, std::span<const Window> windows,
                      std::span<const WindowMotion> field, int window_px);

 private:
  struct Point {
    double x, y;
  };
  double arrow_scale_;
  int origin_x_, origin_y_;
  std::vector<Point> trajectory_;
};

// Writes `lines` into the picture's lower left corner, on a ground of their own, so small that they
// fit: done again, it replaces what stood there.
void write_label(ColourPicture& picture, const std::vector<std::string>& lines);

}  // namespace impactdic::report
