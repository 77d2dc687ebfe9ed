// Device memory and page-locked host memory. A driver takes up to milliseconds for each piece, one
// caller at a time: what nobody uses any more is kept for the next who asks for as much.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "host/opencl/cl.h"

namespace impactdic::opencl {

class MemoryPool;

// A piece of memory, given back when the object goes away. Move-only.
class Memory {
 public:
  Memory() = default;
  ~Memory() { release(); }
  Memory(Memory&& other) noexcept { swap(other); }
  Memory& operator=(Memory&& other) noexcept {
    Memory taken(std::move(other));
    swap(taken);
    return *this;
  }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  const cl::Buffer& buffer() const { return piece_.buffer; }
  // Where the host writes, of page-locked memory; mapped with the first call. Throws cl::Error.
  unsigned char* host();

 private:
  friend class MemoryPool;
  struct Piece {
    cl::Buffer buffer;
    std::size_t bytes = 0;
    cl_mem_flags flags = 0;
    unsigned char* mapped = nullptr;
  };
  void swap(Memory& other) noexcept;
  void release() noexcept;

  Piece piece_;
  cl::CommandQueue queue_;  // the one that uses it
  std::shared_ptr<MemoryPool> pool_;
};

// Safe on several threads.
class MemoryPool : public std::enable_shared_from_this<MemoryPool> {
 public:
  // Keeps at most `most_bytes` that nobody uses; 0: nothing.
  MemoryPool(cl::Context context, std::size_t most_bytes)
      : context_(std::move(context)), most_bytes_(most_bytes) {}

  // `bytes` or some more, with undefined contents, for `queue`. Throws cl::Error.
  Memory take(std::size_t bytes, cl_mem_flags flags, const cl::CommandQueue& queue);
  // That nobody uses.
  std::size_t kept_bytes() const;

 private:
  friend class Memory;
  struct Kept {
    Memory::Piece piece;
    cl::CommandQueue queue;  // that used it
    cl::Event idle;          // when it has come to an end with it
  };
  bool keeps() const { return most_bytes_ > 0; }
  void keep(Kept kept);
  void drop_oldest();
  // Lets go of what is kept where there is no room otherwise.
  cl::Buffer made(std::size_t bytes, cl_mem_flags flags);

  cl::Context context_;
  std::size_t most_bytes_;
  mutable std::mutex mutex_;  // of what follows
  std::vector<Kept> kept_;    // oldest first
  std::size_t kept_bytes_ = 0;
};

}  // namespace impactdic::opencl
