// clFFT plans as objects: baked once per size and batch, released with the object.
#pragma once

#include <cstddef>
#include <memory>

#include "host/opencl/engine.h"

namespace impactdic::opencl {

// Batched two-dimensional complex single-precision transform, in place, interleaved
// (batch, height, width); of height 1, one-dimensional. The inverse is scaled by 1/(width·height).
class FftPlan {
 public:
  // Each side must be a product of 2, 3, 5, 7, 11 and 13 (see good_size). Throws OpenClError.
  FftPlan(Engine& engine, std::size_t width, std::size_t height, std::size_t batch);
  ~FftPlan();
  FftPlan(FftPlan&&) noexcept;
  FftPlan& operator=(FftPlan&&) noexcept;

  void forward(const cl::CommandQueue& queue, const cl::Buffer& data);
  void inverse(const cl::CommandQueue& queue, const cl::Buffer& data);
  std::size_t batch() const;

  // The smallest length that clFFT transforms and that is at least `length`.
  static std::size_t good_size(std::size_t length);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace impactdic::opencl
