#include "host/opencl/staging.h"

namespace impactdic::opencl {

std::span<unsigned char> Staging::bytes(std::size_t count) {
  if (last_() != nullptr) engine_.wait(last_);
  last_ = {};
  if (count > size_) {
    host_ = {};
    try {
      host_ = engine_.allocate(count, CL_MEM_READ_ONLY | CL_MEM_ALLOC_HOST_PTR);
      host_.host();
    } catch (const cl::Error& error) {
      throw OpenClError(std::string(error.what()) + " of " + std::to_string(count) + " bytes",
                        error.err());
    }
    device_ = Buffer<unsigned char>(engine_, count, CL_MEM_READ_ONLY);
    size_ = count;
  }
  return {host_.host(), count};
}

const cl::Buffer& Staging::upload(std::size_t count) {
  last_ = device_.write_later(engine_, {host_.host(), count});
  return device_.get();
}

}  // namespace impactdic::opencl
