// ZNCC of windows on an OpenCL device: the variants of the kernels and their launches.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/dic/device_frames.h"
#include "host/dic/field.h"
#include "host/opencl/buffer.h"
#include "host/opencl/fft_plan.h"

namespace impactdic {

// One way to compute the same correlation. See kernels/correlate.cl and kernels/config.h.
struct ZnccVariant {
  bool fused = true;  // one kernel with its transforms in local memory; else clFFT batches
  int fft_px = 32;
  int vector = 1, lanes = 32, windows_per_group = 1;  // of the fused kernel

  std::size_t local_bytes(const FieldOptions& options) const;
  std::string name() const;  // "fused32 vector 8 lanes 1 windows 1", "clfft 36"
};

// Every variant that the device and the options allow, the one to take without tuning first.
std::vector<ZnccVariant> zncc_variants(const DeviceInfo& device, const FieldOptions& options);

class ZnccOpencl {
 public:
  // Compiles the kernels and bakes the plans. Throws OpenClError, BuildError.
  ZnccOpencl(Engine& engine, const FieldOptions& options, const ZnccVariant& variant);

  // Measures the first `count` windows into the first `count` motions, everything staying on the
  // device; returns when it is enqueued. Windows must name slots that hold frames.
  void run(const DeviceFrames& frames, const Buffer<Window>& windows, std::size_t count,
           Buffer<WindowMotion>& motions);

 private:
  // Peaks of windows start … start + count − 1 into the first `count` peaks.
  void enqueue_fused(const DeviceFrames& frames, const Buffer<Window>& windows, std::size_t start,
                     std::size_t count);
  // Peaks of windows start + at … into peaks at …, `count` (at most one batch) of them.
  void enqueue_batch(const DeviceFrames& frames, const Buffer<Window>& windows, std::size_t start,
                     std::size_t at, std::size_t count);
  // Makes plan and scratch large enough for `count` windows or for one full batch.
  void reserve_batch(std::size_t count);
  float contrast(const DeviceFrames& frames) const;

  Engine& engine_;
  FieldOptions options_;
  ZnccVariant variant_;
  cl::Kernel fused_, cut_, power_, map_, subpixel_;
  std::size_t group_ = 64, batch_ = 0;
  std::optional<FftPlan> plan_;
  Buffer<cl_float> inverses_, maps_;
  Buffer<cl_float2> planes_, levels_, sums_;
  Buffer<CorrelationPeak> peaks_;
};

}  // namespace impactdic
