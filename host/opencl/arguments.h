// All arguments of a kernel in one call.
#pragma once

#include "host/opencl/cl.h"

namespace impactdic::opencl {

// Sets arguments 0, 1, … in order. Throws cl::Error where a size does not fit.
template <typename... Arguments>
void set_arguments(cl::Kernel& kernel, const Arguments&... arguments) {
  cl_uint index = 0;
  (kernel.setArg(index++, arguments), ...);
}

}  // namespace impactdic::opencl
