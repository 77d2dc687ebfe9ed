// Annotated frames: circle, trajectory of the centre and velocity arrows, as in the dissertation's
// Figs 2.10 and 3.9.
#pragma once

#include <impactdic/advice.h>
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
  // Arrows are `arrow_scale` times the displacement to the next frame; 0: so many times that the
  // ball's first motion gets an arrow of up to three tenths of its radius. `earlier`: rows of
  // frames that were painted by another run, for the trajectory and the scale.
  explicit OverlayPainter(double arrow_scale, int origin_x, int origin_y,
                          std::span<const TrackRow> earlier = {});

  // Paints frame after frame; keeps the trajectory. `frame` is a cut-out whose pixel (0, 0) is
  // (origin_x, origin_y) of the picture that `row` and `windows` are measured in. Sides are
  // rounded down to even numbers, as video codecs want them. Of many windows it draws every
  // second, third, … one along both axes, so that arrows can be told apart.
  ColourPicture paint(const Frame& frame, const TrackRow& row, std::span<const Window> windows,
                      std::span<const WindowMotion> field, int window_px);
  double arrow_scale() const;

 private:
  struct Point {
    double x, y;
  };
  void note(const TrackRow& row);

  double arrow_scale_;  // 0: not known yet
  int origin_x_, origin_y_;
  std::vector<Point> trajectory_;
};

// What may be the ball, drawn into frame number `number` of the stored file with their ranks from
// 1: those that this frame shows in one colour, those that another shows better in a fainter one.
ColourPicture draw_candidates(const Frame& frame, std::int64_t number,
                              std::span<const BallSeen> candidates);
// The same as a PNG file. Throws FileError.
void write_candidates(const std::string& path, const Frame& frame, std::int64_t number,
                      std::span<const BallSeen> candidates);

// Writes `lines` into the picture's lower left corner, on a ground of their own, so small that they
// fit: done again, it replaces what stood there.
void write_label(ColourPicture& picture, const std::vector<std::string>& lines);

// What lengths and arrows of a picture stand for.
struct PictureScale {
  double mm_per_px = 0;    // 0: not known, lengths are in px
  double m_s_per_px = 0;   // speed of an arrow of one px; 0: not known
  double arrow_scale = 1;  // an arrow's length over the displacement to the next frame
};

// Writes a scale bar and a reference arrow into the upper right corner, on a ground of their own.
void write_scale(ColourPicture& picture, const PictureScale& scale);

}  // namespace impactdic::report
