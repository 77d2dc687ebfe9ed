#include "host/opencl/staging.h"

#include <algorithm>

namespace impactdic::opencl {

void Staging::reserve(std::size_t pieces, std::size_t piece_bytes) {
  const std::size_t bytes = pieces * piece_bytes;
  if (bytes <= size_ && piece_bytes == piece_bytes_) return;
  for (cl::Event& last : last_) {
    if (last() != nullptr) engine_.wait(last);
    last = {};
  }
  piece_bytes_ = piece_bytes;
  if (bytes <= size_) return;
  size_ = 0;
  host_ = {};
  try {
    host_ = engine_.allocate(bytes, CL_MEM_READ_ONLY | CL_MEM_ALLOC_HOST_PTR);
    host_.host();
  } catch (const cl::Error& error) {
    throw OpenClError(std::string(error.what()) + " of " + std::to_string(bytes) + " bytes",
                      error.err());
  }
  size_ = bytes;
}

const cl::Buffer& Staging::upload(std::size_t rows, std::size_t row_bytes, const FillRows& fill) {
  const std::size_t most = std::clamp<std::size_t>(kPieceBytes / row_bytes, 1, rows);
  const std::size_t pieces = std::min((rows + most - 1) / most, kPieces);
  reserve(pieces, most * row_bytes);
  if (device_.size() < rows * row_bytes) {
    device_ = Buffer<unsigned char>(engine_, rows * row_bytes, CL_MEM_READ_ONLY);
  }
  std::size_t piece = 0;
  for (std::size_t first = 0; first < rows; first += most, piece = (piece + 1) % pieces) {
    const std::size_t count = std::min(most, rows - first);
    unsigned char* const at = host_.host() + piece * piece_bytes_;
    if (last_[piece]() != nullptr) engine_.wait(last_[piece]);
    fill(first, count, at);
    last_[piece] = device_.write_later(engine_, {at, count * row_bytes}, first * row_bytes);
  }
  return device_.get();
}

}  // namespace impactdic::opencl
