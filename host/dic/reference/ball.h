// Whole-ball registration in double precision on the host: what kernels/ball/rigid.cl is tested
// against. Slow.
#pragma once

#include <impactdic/image.h>

#include "host/dic/device/ball.h"

namespace impactdic::dic {

// One ball between two frames; the task's slots are not looked at. As BallRegistration::measure,
// but iterated to double precision, with the median of the residuals by sorting and without
// standard deviations (the accuracy tests hold those against the errors themselves).
BallMotion ball_reference(const Frame& first, const Frame& second, const BallTask& task,
                          const BallOptions& options);

}  // namespace impactdic::dic
