// The OpenCL C sources: embedded in the binary by CMake, or read from a folder while a kernel is
// worked on (EngineOptions::kernel_dir, $IMPACTDIC_KERNEL_DIR).
#pragma once

#include <string>

namespace impactdic::opencl {

// Source of kernels/NAME with every `#include "kernels/x.h"` replaced by that file's text, each
// file once, and #line directives so that a build log names the file. `folder` is the repository's
// root, "" for the embedded sources. Throws BuildError for a file that is not there.
std::string kernel_source(const std::string& name, const std::string& folder = "");

}  // namespace impactdic::opencl
