// Typed device memory: move-only, sized in elements.
#pragma once

#include <impactdic/error.h>

#include <span>
#include <string>
#include <vector>

#include "host/opencl/engine.h"

namespace impactdic::opencl {

template <typename T>
class Buffer {
 public:
  Buffer() = default;
  // Allocates `count` elements, with undefined contents.
  // Throws OpenClError.
  Buffer(const Engine& engine, std::size_t count, cl_mem_flags flags = CL_MEM_READ_WRITE)
      : count_(count) {
    try {
      memory_ = engine.allocate(count * sizeof(T), flags);
    } catch (const cl::Error& error) {
      throw OpenClError(
          std::string(error.what()) + " of " + std::to_string(count * sizeof(T)) + " bytes",
          error.err());
    }
  }
  Buffer(Buffer&&) noexcept = default;
  // OpenCL could refuse to release what was held, which only a handle that is none makes it do.
  Buffer& operator=(Buffer&&) noexcept = default;  // NOLINT(bugprone-exception-escape)
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  std::size_t size() const { return count_; }
  const cl::Buffer& get() const { return memory_.buffer(); }

  // Blocking copies on the engine's queue; `offset` in elements. Throw OpenClError, and
  // InvalidArgument where they would pass the end.
  void write(Engine& engine, std::span<const T> host, std::size_t offset = 0) {
    enqueue_write(engine, CL_TRUE, host, offset);
  }
  // The same without waiting: `host` must stay until the event that it returns (null where there is
  // nothing to copy) or the queue has been waited for, which `read` does.
  cl::Event write_later(Engine& engine, std::span<const T> host, std::size_t offset = 0) {
    return enqueue_write(engine, CL_FALSE, host, offset);
  }
  void read(Engine& engine, std::span<T> host, std::size_t offset = 0) const {
    if (!fits(host.size(), offset)) return;
    try {
      engine.wait();
      cl::Event event;
      engine.queue().enqueueReadBuffer(get(), CL_TRUE, offset * sizeof(T), host.size_bytes(),
                                       host.data(), nullptr, &event);
      engine.profiler().add("copy from device", event, static_cast<double>(host.size_bytes()));
    } catch (const cl::Error& error) {
      throw OpenClError(error.what(), error.err());
    }
  }
  std::vector<T> to_vector(Engine& engine) const {
    std::vector<T> host(count_);
    read(engine, host);
    return host;
  }
  // Grows to at least `count` elements; the contents are then undefined.
  void reserve(const Engine& engine, std::size_t count) {
    if (count > count_) *this = Buffer(engine, count);
  }

 private:
  cl::Event enqueue_write(Engine& engine, cl_bool blocking, std::span<const T> host,
                          std::size_t offset) {
    cl::Event event;
    if (!fits(host.size(), offset)) return event;
    try {
      engine.queue().enqueueWriteBuffer(get(), blocking, offset * sizeof(T), host.size_bytes(),
                                        host.data(), nullptr, &event);
      engine.profiler().add("copy to device", event, static_cast<double>(host.size_bytes()));
    } catch (const cl::Error& error) {
      throw OpenClError(error.what(), error.err());
    }
    return event;
  }
  // False where there is nothing to copy.
  bool fits(std::size_t count, std::size_t offset) const {
    if (offset + count > count_) throw InvalidArgument("copy beyond the end of a device buffer");
    return count != 0;
  }

  Memory memory_;
  std::size_t count_ = 0;
};

template <typename T>
Buffer<T> make_buffer(Engine& engine, std::span<const T> host) {
  Buffer<T> buffer(engine, host.size());
  buffer.write(engine, host);
  return buffer;
}

}  // namespace impactdic::opencl
