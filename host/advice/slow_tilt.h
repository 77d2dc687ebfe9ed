// A turn out of the picture's plane that is too slow for neighbouring frames to show.
#pragma once

#include "host/advice/sphere_radius.h"

namespace impactdic::advice {

// Two pictures some frames apart show what adds up in between: a tilt of a thirtieth of a degree a
// frame, or the turn that a camera sees of a ball which flies past it near by. Taken for a flat
// ball it would seem to move by two thirds of the radius times that. `step`, the flat ball's motion
// a frame, with such a tilt where the first picture of `pair`, registered as a sphere's against two
// pictures at different distances in time, shows the same tilt a frame beyond chance, and fits both
// better than a flat ball; else nullopt.
std::optional<dic::RigidMotion> slow_tilt(opencl::Engine& engine, const BallPair& pair,
                                          const dic::RigidMotion& step, const FieldOptions& field,
                                          const FarFrames& frames);

}  // namespace impactdic::advice
