#include "host/benchmark/equal_stream.h"

#include "host/dic/device/tuning.h"
#include "host/opencl/pinned.h"

namespace impactdic::benchmark {

// One batch with a queue of its own: what the queues of several workers hold runs side by side.
struct EqualStream::Worker {
  std::unique_ptr<opencl::Engine> engine;
  Shape shape;
  opencl::PinnedBytes pictures, motions;
  opencl::Buffer<unsigned char> pixels;
  opencl::Buffer<Window> windows;
  opencl::Buffer<WindowMotion> results;
  dic::EqualOpencl equal;
  cl::Event done;

  Worker(const opencl::Engine& parent, const FieldOptions& options, const Shape& of,
         std::span<const Window> list)
      : engine(parent.beside()),
        shape(of),
        pictures(*engine, bytes_of(of)),
        motions(*engine, list.size_bytes() / sizeof(Window) * sizeof(WindowMotion)),
        pixels(*engine, bytes_of(of) + dic::kBytesBehind, CL_MEM_READ_ONLY),
        windows(opencl::make_buffer<Window>(*engine, list)),
        results(*engine, list.size()),
        equal(*engine, options,
              dic::choose_equal_variant(*engine, options.window_px, of.period > 0)) {}

  static std::size_t bytes_of(const Shape& shape) {
    return static_cast<std::size_t>(shape.width) * static_cast<std::size_t>(shape.height) *
           static_cast<std::size_t>(shape.pictures) * (shape.type == PixelType::kU8 ? 1 : 2);
  }

  void start() {
    const cl::CommandQueue& queue = engine->queue();
    try {
      const auto from = pictures.bytes(), to = motions.bytes();
      cl::Event copied;
      queue.enqueueWriteBuffer(pixels.get(), CL_FALSE, 0, bytes_of(shape), from.data(), nullptr,
                               &copied);
      engine->profiler().add("copy to device", copied, static_cast<double>(bytes_of(shape)));
      equal.run({pixels.get(), shape.width, shape.height, shape.type, shape.full_scale}, windows,
                windows.size(), results, shape.period);
      queue.enqueueReadBuffer(results.get(), CL_FALSE, 0, windows.size() * sizeof(WindowMotion),
                              to.data(), nullptr, &done);
      engine->profiler().add("copy from device", done,
                             static_cast<double>(windows.size() * sizeof(WindowMotion)));
      queue.flush();
    } catch (const cl::Error& error) {
      throw OpenClError(error.what(), error.err());
    }
  }

  std::span<const WindowMotion> wait() {
    try {
      if (done() != nullptr) done.wait();
    } catch (const cl::Error& error) {
      throw OpenClError(error.what(), error.err());
    }
    return {reinterpret_cast<const WindowMotion*>(motions.bytes().data()), windows.size()};
  }
};

EqualStream::EqualStream(const opencl::Engine& engine, const FieldOptions& options,
                         const Shape& shape, std::span<const Window> windows, int workers) {
  for (const Window& window : windows) {
    if (std::min(window.first, window.second) < 0 ||
        std::max(window.first, window.second) >= shape.pictures) {
      throw InvalidArgument("a window names a picture that its batch does not have");
    }
  }
  for (int k = 0; k < workers; ++k) {
    workers_.push_back(std::make_unique<Worker>(engine, options, shape, windows));
  }
}

EqualStream::~EqualStream() {
  for (const auto& worker : workers_) {
    try {
      worker->wait();
    } catch (const Error&) {
      // Whoever waited before has seen it.
    }
  }
}

std::span<unsigned char> EqualStream::pictures(int worker) {
  return workers_.at(static_cast<std::size_t>(worker))->pictures.bytes();
}
void EqualStream::start(int worker) { workers_.at(static_cast<std::size_t>(worker))->start(); }
std::span<const WindowMotion> EqualStream::wait(int worker) {
  return workers_.at(static_cast<std::size_t>(worker))->wait();
}

}  // namespace impactdic::benchmark
