// One engine for all tests of a program: devices are slow to open and kernels slow to compile.
#pragma once

#include <cstdlib>

#include "host/opencl/engine.h"

namespace impactdic::testing {

// The device named by IMPACTDIC_TEST_DEVICE, else the one `auto` takes.
inline opencl::Engine& shared_engine() {
  static opencl::Engine engine(
      std::getenv("IMPACTDIC_TEST_DEVICE") ? std::getenv("IMPACTDIC_TEST_DEVICE") : "auto");
  return engine;
}

}  // namespace impactdic::testing
