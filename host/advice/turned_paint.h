// The paint that two pictures of a sphere both show.
#pragma once

#include <vector>

#include "host/motion/perspective.h"
#include "host/sphere/carried_paint.h"

namespace impactdic::advice {

// At places evenly over the ball of the first picture that the second one shows as well, after the
// motion `found`; `seen` as it was registered with.
std::vector<sphere::CarriedPaint> turned_paint(const Frame& first, const Frame& second,
                                               const BallMotion& found,
                                               const motion::Perspective& seen);

}  // namespace impactdic::advice
