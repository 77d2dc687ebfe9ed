#include "host/opencl/memory.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace impactdic::opencl {
namespace {

// Pieces come in eight sizes an octave, so that one fits the next clip's, whose ball is a little
// larger.
constexpr std::size_t kLeastStep = 4096, kSizesPerOctave = 8;

std::size_t rounded(std::size_t bytes) {
  const std::size_t step = std::max(kLeastStep, std::bit_floor(bytes) / kSizesPerOctave);
  return (bytes + step - 1) / step * step;
}

bool is_over(const cl::Event& event) {
  return event.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>() == CL_COMPLETE;
}

}  // namespace

unsigned char* Memory::host() {
  if (piece_.mapped == nullptr) {
    piece_.mapped = static_cast<unsigned char*>(
        queue_.enqueueMapBuffer(piece_.buffer, CL_TRUE, CL_MAP_WRITE, 0, piece_.bytes));
  }
  return piece_.mapped;
}

void Memory::swap(Memory& other) noexcept {
  std::swap(piece_, other.piece_);
  std::swap(queue_, other.queue_);
  std::swap(pool_, other.pool_);
}

void Memory::release() noexcept {
  if (!pool_) return;
  const auto settle = [this] {
    try {
      queue_.finish();
    } catch (const cl::Error&) {
      // A device that is lost does nothing any more.
    }
  };
  try {
    if (pool_->keeps()) {
      cl::Event idle;
      queue_.enqueueMarkerWithWaitList(nullptr, &idle);
      queue_.flush();
      pool_->keep({std::move(piece_), queue_, idle});
    } else if (piece_.mapped != nullptr) {
      queue_.enqueueUnmapMemObject(piece_.buffer, piece_.mapped);
      settle();
    }
  } catch (...) {
    // The context goes away, and the memory with it; not before copies from there have ended.
    settle();
  }
  piece_ = {};
  pool_.reset();
}

Memory MemoryPool::take(std::size_t bytes, cl_mem_flags flags, const cl::CommandQueue& queue) {
  bytes = std::max<std::size_t>(bytes, 1);  // OpenCL knows no empty buffer
  Memory memory;
  memory.queue_ = queue;
  memory.piece_.bytes = keeps() ? rounded(bytes) : bytes;
  memory.piece_.flags = flags;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) {
      return kept.piece.bytes == memory.piece_.bytes && kept.piece.flags == flags &&
             is_over(kept.idle);
    });
    if (found != kept_.end()) {
      memory.piece_ = std::move(found->piece);
      kept_bytes_ -= memory.piece_.bytes;
      kept_.erase(found);
    }
  }
  if (memory.piece_.buffer() == nullptr) memory.piece_.buffer = made(memory.piece_.bytes, flags);
  memory.pool_ = shared_from_this();
  return memory;
}

std::size_t MemoryPool::kept_bytes() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return kept_bytes_;
}

cl::Buffer MemoryPool::made(std::size_t bytes, cl_mem_flags flags) {
  try {
    return {context_, flags, bytes};
  } catch (const cl::Error&) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (kept_.empty()) throw;
    while (!kept_.empty()) drop_oldest();
  }
  return {context_, flags, bytes};
}

void MemoryPool::keep(Kept kept) {
  const std::lock_guard<std::mutex> lock(mutex_);
  kept_bytes_ += kept.piece.bytes;
  kept_.push_back(std::move(kept));
  while (kept_bytes_ > most_bytes_) drop_oldest();
}

void MemoryPool::drop_oldest() {
  const Kept oldest = std::move(kept_.front());
  kept_.erase(kept_.begin());
  kept_bytes_ -= oldest.piece.bytes;
  if (oldest.piece.mapped == nullptr) return;
  oldest.queue.enqueueUnmapMemObject(oldest.piece.buffer, oldest.piece.mapped);
  oldest.queue.finish();
}

}  // namespace impactdic::opencl
