// The paint that pictures of a sphere show.
#pragma once

#include <vector>

#include "host/motion/perspective.h"
#include "host/sphere/bare_paint.h"
#include "host/sphere/carried_paint.h"

namespace impactdic::advice {

// At places evenly over the ball of the first picture that the second one shows as well, after the
// motion `found`; `seen` as it was registered with.
std::vector<sphere::CarriedPaint> turned_paint(const Frame& first, const Frame& second,
                                               const BallMotion& found,
                                               const motion::Perspective& seen);

// At places evenly over the ball of one picture.
std::vector<sphere::SeenPaint> seen_paint(const Frame& picture, const Circle& ball);

}  // namespace impactdic::advice
