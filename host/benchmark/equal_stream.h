// Equal windows on a stream of pictures from page-locked host memory to displacements in it: while
// one batch is copied, the windows of another are measured and the results of a third come back.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "host/dic/device/equal.h"

namespace impactdic::benchmark {

class EqualStream {
 public:
  struct Shape {
    int width = 0, height = 0;
    PixelType type = PixelType::kU8;
    double full_scale = 255;  // grey level of white
    int pictures = 0;         // of a batch
    std::size_t period = 0;   // of its windows, see dic::EqualOpencl::run
  };
  // `workers` batches are under way at a time. `windows`: of a batch, their slots its pictures. The
  // options are those of dic::EqualOpencl. `engine` must outlive the object. Throws
  // InvalidArgument, OpenClError.
  EqualStream(const opencl::Engine& engine, const FieldOptions& options, const Shape& shape,
              std::span<const Window> windows, int workers);
  ~EqualStream();

  int workers() const { return static_cast<int>(workers_.size()); }
  // Page-locked memory for the pictures of a worker, one behind the other without gaps. It may be
  // written when the worker's batch is done, and is left as it is.
  std::span<unsigned char> pictures(int worker);
  // Enqueues a worker's batch: its pictures as they are now.
  void start(int worker);
  // Waits for it. The motions, in the order of the windows, stay until the worker's next start.
  std::span<const WindowMotion> wait(int worker);

 private:
  struct Worker;
  std::vector<std::unique_ptr<Worker>> workers_;
};

}  // namespace impactdic::benchmark
