// The registration of a sphere in double precision: see ball.h.
#pragma once

#include <impactdic/image.h>

#include "host/dic/device/ball.h"

namespace impactdic::dic {

// What ball_reference does for BallModel::kSphere. The derivatives are differences of the warp
// itself taken on the first picture's B-spline, so that a slip in the kernel's algebra shows.
BallMotion sphere_reference(const Frame& first, const Frame& second, const BallTask& task,
                            const BallOptions& options);

}  // namespace impactdic::dic
