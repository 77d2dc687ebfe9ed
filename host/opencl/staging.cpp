#include "host/opencl/staging.h"

namespace impactdic::opencl {

Staging::~Staging() { release(); }

void Staging::release() noexcept {
  if (mapped_ == nullptr) return;
  try {
    engine_.queue().enqueueUnmapMemObject(host_, mapped_);
    engine_.queue().finish();
  } catch (const cl::Error&) {
    // The context goes away, and the memory with it.
  }
  mapped_ = nullptr;
}

std::span<unsigned char> Staging::bytes(std::size_t count) {
  if (last_() != nullptr) engine_.wait(last_);
  last_ = {};
  if (count > size_) {
    release();
    try {
      host_ = cl::Buffer(engine_.context(), CL_MEM_READ_ONLY | CL_MEM_ALLOC_HOST_PTR, count);
      mapped_ = static_cast<unsigned char*>(
          engine_.queue().enqueueMapBuffer(host_, CL_TRUE, CL_MAP_WRITE, 0, count));
    } catch (const cl::Error& error) {
      throw OpenClError(std::string(error.what()) + " of " + std::to_string(count) + " bytes",
                        error.err());
    }
    device_ = Buffer<unsigned char>(engine_, count, CL_MEM_READ_ONLY);
    size_ = count;
  }
  return {mapped_, count};
}

const cl::Buffer& Staging::upload(std::size_t count) {
  last_ = device_.write_later(engine_, {mapped_, count});
  return device_.get();
}

}  // namespace impactdic::opencl
