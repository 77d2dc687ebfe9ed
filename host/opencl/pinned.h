// Page-locked host memory: copies to and from a device run at the bus's full speed, beside the
// host's own work.
#pragma once

#include <span>

#include "host/opencl/engine.h"

namespace impactdic::opencl {

class PinnedBytes {
 public:
  // `engine` must outlive the object. Throws OpenClError.
  PinnedBytes(const Engine& engine, std::size_t count);
  ~PinnedBytes();
  PinnedBytes(const PinnedBytes&) = delete;
  PinnedBytes& operator=(const PinnedBytes&) = delete;

  std::span<unsigned char> bytes() const { return {mapped_, count_}; }

 private:
  const Engine& engine_;
  std::size_t count_;
  cl::Buffer buffer_;
  unsigned char* mapped_ = nullptr;
};

}  // namespace impactdic::opencl
