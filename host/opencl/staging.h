// Bytes on their way to the device: page-locked host memory, from which copies run at the bus's
// full speed, and the device memory that they go to.
#pragma once

#include <array>
#include <functional>

#include "host/opencl/buffer.h"

namespace impactdic::opencl {

class Staging {
 public:
  explicit Staging(Engine& engine) : engine_(engine) {}
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  // Writes rows first … first + count - 1, one behind the other, to `to`.
  using FillRows = std::function<void(std::size_t first, std::size_t count, unsigned char* to)>;
  // Has `rows` rows of `row_bytes` copied to the device, before what is enqueued next. `fill` is
  // called for some of them at a time, while those before are copied. Throws OpenClError.
  const cl::Buffer& upload(std::size_t rows, std::size_t row_bytes, const FillRows& fill);

 private:
  // Little memory, which is written again and again: a driver locks pages for one caller at a time,
  // and what was just written is still in a cache when the device reads it.
  static constexpr std::size_t kPieceBytes = std::size_t{512} << 10, kPieces = 4;

  void reserve(std::size_t pieces, std::size_t piece_bytes);

  Engine& engine_;
  std::size_t size_ = 0, piece_bytes_ = 0;
  Memory host_;                          // of the pieces, one behind the other
  std::array<cl::Event, kPieces> last_;  // upload from each
  Buffer<unsigned char> device_;
};

}  // namespace impactdic::opencl
