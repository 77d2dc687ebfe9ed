// All arguments of a kernel in one call.
#pragma once

#include <impactdic/error.h>

#include "host/opencl/cl.h"

namespace impactdic::opencl {

// Throws OpenClError where a size does not fit.
template <typename Argument>
void set_argument(cl::Kernel& kernel, cl_uint index, const Argument& argument) {
  try {
    kernel.setArg(index, argument);
  } catch (const cl::Error& error) {
    throw OpenClError(error.what(), error.err());
  }
}

// Sets arguments 0, 1, … in order. Throws OpenClError where a size does not fit.
template <typename... Arguments>
void set_arguments(cl::Kernel& kernel, const Arguments&... arguments) {
  cl_uint index = 0;
  (set_argument(kernel, index++, arguments), ...);
}

}  // namespace impactdic::opencl
