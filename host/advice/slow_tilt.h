// A turn out of the picture's plane that is too slow for neighbouring frames to show.
#pragma once

#include "host/advice/sphere_radius.h"

namespace impactdic::advice {

// What pictures some frames apart say of the tilt a frame.
struct SlowTilt {
  std::optional<dic::RigidMotion> motion;  // a frame, with the tilt; nullopt where none is shown
  // Else what tilt there may be and not show, rad a frame; NaN where no picture could be
  // registered.
  double unseen_rad = kNotMeasured;
  // The ball's shape differs in the two pictures, as where it is pressed in one of them. Taken for
  // a tilt it makes up to a tenth of a degree a frame.
  bool is_pressed = false;
};

// Pictures some frames apart show what adds up in between: a tilt of a thirtieth of a degree a
// frame, or the turn that a camera sees of a ball which flies past it near by. Taken for a flat
// ball it would seem to move by two thirds of the radius times that. The first picture of `pair` is
// registered as a sphere's against one up to 24 frames away, or, where that fails, against ever
// farther ones, each begun from what the one before told; `step`: the flat ball's motion a frame. A
// tilt is there where two of them show the same a frame, beyond chance, and the farther one fits
// better than a flat ball.
SlowTilt slow_tilt(opencl::Engine& engine, const BallPair& pair, const dic::RigidMotion& step,
                   const motion::EstimatorOptions& options, const FarFrames& frames);

}  // namespace impactdic::advice
