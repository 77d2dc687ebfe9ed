// ZNCC of windows on an OpenCL device: the variants of the kernels and their launches.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/dic/field.h"
#include "host/dic/frames/device_frames.h"
#include "host/opencl/buffer.h"
#include "host/opencl/fft_plan.h"

namespace impactdic::dic {

// How a correlation is computed.
enum class ZnccPath {
  kBytes,  // a window a group of 32 in one kernel without transforms (kernels/zncc/bytes.cl): 8-bit
           // pictures (others go another path), windows up to 31, 33 lags
  kPairs,  // two windows a group in one kernel (kernels/zncc/pairs*.cl): transforms of 16 and 32
  kSingle,  // a window a group in one kernel (kernels/zncc/single*.cl): transforms of 16, 32 and 64
  kClfft,   // several kernels about clFFT's batches: any size
};

// One way to compute the same correlation. See kernels/lanes.h and kernels/config.h.
struct ZnccVariant {
  ZnccPath path = ZnccPath::kPairs;
  int fft_px = 32;
  int vector = 1, lanes = 32;
  // Of vector 1 alone:
  bool width_known = false;   // the pictures' width compiled in
  bool warp_barrier = false;  // a group is one warp of an NVIDIA device
  int most_registers = 0;     // of a work-item, for NVIDIA's compiler; 0: its choice
  bool matrix_units = false;  // of an NVIDIA device, which multiply matrices of bytes

  std::size_t local_bytes(const FieldOptions& options) const;
  std::string name() const;  // "pairs 32 vector 8 lanes 1", "clfft 36"
};

// Every variant that the device and the options allow, the one to take without tuning first.
std::vector<ZnccVariant> zncc_variants(const opencl::Device& device, const FieldOptions& options);

// Real operations of a window: one complex transform there and one back, 5 N log2 N each (the usual
// count).
double zncc_flops(const ZnccVariant& variant);

class ZnccOpencl {
 public:
  // Compiles the kernels and bakes the plans. Throws OpenClError, BuildError.
  ZnccOpencl(opencl::Engine& engine, const FieldOptions& options, const ZnccVariant& variant);

  // What it runs on pictures of this depth and width, the largest first; not of the path kClfft.
  // `engine` may be one that is not open yet (EngineOptions::expects).
  static std::vector<opencl::ProgramRequest> programs(const opencl::Engine& engine,
                                                      const FieldOptions& options,
                                                      const ZnccVariant& variant, PixelType type,
                                                      int width);

  // Measures the first `count` windows into the first `count` motions, everything staying on the
  // device; returns when it is enqueued. Windows must name slots that hold frames.
  void run(const DeviceFrames& frames, const opencl::Buffer<Window>& windows, std::size_t count,
           opencl::Buffer<WindowMotion>& motions);

 private:
  // Peaks of windows start … start + count − 1 into the first `count` peaks.
  void enqueue_fused(const DeviceFrames& frames, const opencl::Buffer<Window>& windows,
                     std::size_t start, std::size_t count);
  // Peaks of windows start + at … into peaks at …, `count` (at most one batch) of them.
  void enqueue_batch(const DeviceFrames& frames, const opencl::Buffer<Window>& windows,
                     std::size_t start, std::size_t at, std::size_t count);
  // Compiles what depends on the pictures' depth and width.
  void compile_fused(const DeviceFrames& frames);
  // Makes plan and scratch large enough for `count` windows or for one full batch.
  void reserve_batch(std::size_t count);
  float contrast(const DeviceFrames& frames) const;

  opencl::Engine& engine_;
  FieldOptions options_;
  ZnccVariant variant_;
  opencl::Defines fused_defines_;
  cl::Kernel fused_, cut_, power_, map_, subpixel_;
  std::size_t group_ = 64, batch_ = 0;
  std::optional<opencl::FftPlan> plan_;
  opencl::Buffer<cl_float> weights_, maps_;
  opencl::Buffer<cl_float2> planes_, levels_, sums_;
  opencl::Buffer<CorrelationPeak> peaks_;
  std::unique_ptr<ZnccOpencl> for_deep_pixels_;  // where the path is bytes
};

}  // namespace impactdic::dic
