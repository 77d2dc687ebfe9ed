// A ball's outline in a picture.
#pragma once

#include <impactdic/export.h>

namespace IMPACTDIC_PUBLIC impactdic {

// Centre and radius, px, x right, y down.
struct Circle {
  double cx_px = 0, cy_px = 0, r_px = 0;
  // How far from the centre the ball is free of what hides it, on all sides: up to the straight
  // edge that would hide the widest part of the rim without edges (the frame of a racket, the
  // picture's own edge). The radius where the rim has no such part; 0 where it is not known.
  double free_px = 0;
};

}  // namespace impactdic
