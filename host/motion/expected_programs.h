// What a clip will need of the device, known before anything of it is measured.
#pragma once

#include <cstdint>
#include <vector>

#include "host/motion/motion_estimator.h"
#include "host/opencl/engine.h"

namespace impactdic::motion {

// What is known of it.
struct ExpectedClip {
  PixelType type = PixelType::kU8;  // of its pictures
  std::int64_t frames = 0;
  bool any_body = true;  // it may turn out to be a sphere
};

// The programs that measure such a clip as `options` say, those that take longest to
// compile first; behind them what a ball needs in addition that turns out to be a sphere, where it
// may. `engine` may be one that is not open yet (opencl::EngineOptions::expects).
std::vector<opencl::ProgramRequest> expected_programs(const opencl::Engine& engine,
                                                      const EstimatorOptions& options,
                                                      const ExpectedClip& clip);

}  // namespace impactdic::motion
