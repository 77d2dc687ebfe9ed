// The published method on an OpenCL device (kernels/published/published.cl).
#pragma once

#include "host/dic/field.h"
#include "host/dic/frames/device_frames.h"
#include "host/opencl/buffer.h"

namespace impactdic::dic {

class PublishedOpencl {
 public:
  // Compiles the kernel and computes the lag matrices. Throws OpenClError, BuildError.
  PublishedOpencl(opencl::Engine& engine, const FieldOptions& options);

  // Measures the first `count` windows into the first `count` motions, everything staying on the
  // device; returns when it is enqueued. Windows must name slots that hold frames.
  void run(const DeviceFrames& frames, const opencl::Buffer<Window>& windows, std::size_t count,
           opencl::Buffer<WindowMotion>& motions);

 private:
  opencl::Engine& engine_;
  FieldOptions options_;
  std::size_t group_ = 1;
  cl::Kernel kernel_;
  opencl::Buffer<cl_float> matrices_, scratch_;
};

}  // namespace impactdic::dic
