// Bytes on their way to the device: page-locked host memory, from which copies run at the bus's
// full speed, and the device memory that they go to.
#pragma once

#include <memory>
#include <span>

#include "host/opencl/buffer.h"

namespace impactdic::opencl {

class Staging {
 public:
  explicit Staging(Engine& engine) : engine_(engine) {}
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  // Host memory for `count` bytes, when the last upload has left it; write there, then call
  // `upload`. Throws OpenClError.
  std::span<unsigned char> bytes(std::size_t count);
  // Has the first `count` bytes copied to the device, before what is enqueued next.
  const cl::Buffer& upload(std::size_t count);

 private:
  Engine& engine_;
  std::size_t size_ = 0;
  Memory host_;
  cl::Event last_;  // upload
  Buffer<unsigned char> device_;
};

}  // namespace impactdic::opencl
