// How kernels that work on pictures are shared out on a device.
#pragma once

#include <optional>

#include "host/opencl/engine.h"

namespace impactdic::dic {

struct Tiling {
  int vector = 1;  // pixels of a row in one work-item
  int group = 32;  // work-items of a task
};
// The tiling asked for; without one, `group_on_gpu` work-items on a GPU (at most what the device
// takes), and vectors as wide as the SIMD unit in single work-items on a CPU.
// Throws InvalidArgument unless the vector is 1, 4, 8 or 16 and the group a power of two.
Tiling choose_tiling(const opencl::Engine& engine, std::optional<Tiling> asked, int group_on_gpu);

}  // namespace impactdic::dic
