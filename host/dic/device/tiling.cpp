#include "host/dic/device/tiling.h"

#include <impactdic/error.h>

namespace impactdic::dic {

Tiling choose_tiling(const opencl::Engine& engine, std::optional<Tiling> asked, int group_on_gpu) {
  if (asked) {
    const int vector = asked->vector, group = asked->group;
    if ((vector != 1 && vector != 4 && vector != 8 && vector != 16) || group < 1 ||
        (group & (group - 1)) != 0) {
      throw InvalidArgument("a tiling's vector must be 1, 4, 8 or 16 and its group a power of two");
    }
    return *asked;
  }
  Tiling tiling;
  if (engine.device().is_gpu) {
    while (static_cast<std::size_t>(group_on_gpu) > engine.device().max_work_group) {
      group_on_gpu /= 2;
    }
    tiling.group = group_on_gpu;
    return tiling;
  }
  cl_uint width = 1;
  engine.device().handle.getInfo(CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT, &width);
  tiling.vector = width >= 16 ? 16 : width >= 8 ? 8 : 4;
  tiling.group = 1;
  return tiling;
}

}  // namespace impactdic::dic
