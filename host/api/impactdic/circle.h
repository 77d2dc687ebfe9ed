// A ball's outline in a picture.
#pragma once

#include <impactdic/export.h>

#include <cstdint>

namespace IMPACTDIC_PUBLIC impactdic {

// Centre and radius, px, x right, y down.
struct Circle {
  double cx_px = 0, cy_px = 0, r_px = 0;
  // How far from the centre the ball is free of what hides it, on all sides: up to the straight
  // edge that would hide the widest part of the rim without edges (the frame of a racket, the
  // picture's own edge). The radius where the rim has no such part; 0 where it is not known.
  double free_px = 0;
};

// A frame in which a person says where the ball is: its circle, px of the whole picture; with a
// radius of 0 that the frame shows no ball.
struct BallByHand {
  std::int64_t frame = 0;  // of the stored file
  double cx_px = 0, cy_px = 0, r_px = 0;
  bool operator==(const BallByHand&) const = default;
};

// What such a word has done in a frame.
enum class ByHand {
  kNo,      // none was given: the ball was looked for
  kGuided,  // its circle was measured from the one given
  kDrawn,   // no rim was found there: it is the one given, with the deviations of a hand's drawing
  kAbsent,  // it was said that there is no ball
};

}  // namespace impactdic
