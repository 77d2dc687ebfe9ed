#include "host/opencl/pinned.h"

#include <impactdic/error.h>

#include <algorithm>
#include <string>

namespace impactdic::opencl {

PinnedBytes::PinnedBytes(const Engine& engine, std::size_t count)
    : engine_(engine), count_(std::max<std::size_t>(count, 1)) {
  try {
    buffer_ = cl::Buffer(engine.context(), CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, count_);
    mapped_ = static_cast<unsigned char*>(
        engine.queue().enqueueMapBuffer(buffer_, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, count_));
  } catch (const cl::Error& error) {
    throw OpenClError(
        std::string(error.what()) + " of " + std::to_string(count_) + " page-locked bytes",
        error.err());
  }
}

PinnedBytes::~PinnedBytes() {
  try {
    engine_.queue().enqueueUnmapMemObject(buffer_, mapped_);
  } catch (const cl::Error&) {
    // The context goes away, and the memory with it.
  }
  engine_.settle();
}

}  // namespace impactdic::opencl
