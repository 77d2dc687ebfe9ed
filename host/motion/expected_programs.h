// What a clip will need of the device, known before anything of it is measured.
#pragma once

#include <vector>

#include "host/motion/motion_estimator.h"
#include "host/opencl/engine.h"

namespace impactdic::motion {

// The programs that measure pictures of this depth as `options` say, those that take longest to
// compile first; behind them, where `any_body`, what a ball needs in addition that turns out to be
// a sphere. `engine` may be one that is not open yet (opencl::EngineOptions::expects).
std::vector<opencl::ProgramRequest> expected_programs(const opencl::Engine& engine,
                                                      const EstimatorOptions& options,
                                                      PixelType type, bool any_body);

}  // namespace impactdic::motion
