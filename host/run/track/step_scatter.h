// Whether motions state what they err by: what a flight shows of them once it is known.
#pragma once

#include <impactdic/track.h>

#include <memory>
#include <string>

#include "host/clip/track_rows.h"

namespace impactdic::run {

// How many times what they state displacements, turns in the picture's plane and turns out of it
// scatter by; 1 where that may be chance.
struct StepScatter {
  double move = 1, turn = 1, tilt = 1;
  bool is_more() const { return move > 1 || turn > 1 || tilt > 1; }
  // Has a motion state it.
  void widen(TrackRow& row) const;
  std::string warning() const;
};

// In a free flight the displacements of some frames that follow each other lie on a line, which
// gravity and drag bend by less than they err, and turns are the flight's spin. What they lie off
// by is their error, whatever made it. Noise that is alike in neighbouring pixels, a colour
// camera's mosaic or a thing before the ball makes it larger than the pictures' residuals tell.
// `rows`: one a frame, those that `impact` was found in, with that inclination of the surface.
StepScatter scatter_of_steps(const TrackRows& rows, const ImpactAnalysis& impact,
                             double surface_angle_rad);

}  // namespace impactdic::run
