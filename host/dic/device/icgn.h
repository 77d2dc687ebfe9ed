// IC-GN refinement of interrogation windows on the device (kernels/icgn/icgn.cl).
#pragma once

#include <memory>
#include <vector>

#include "host/dic/field.h"
#include "host/dic/frames/device_frames.h"
#include "host/dic/frames/spline_frames.h"

namespace impactdic::dic {

class IcgnRefiner {
 public:
  // Takes window_px, spline_degree, max_iterations, min_correlation and min_texture of `options`.
  // `engine` must outlive the refiner. Throws InvalidArgument.
  IcgnRefiner(opencl::Engine& engine, const FieldOptions& options, int slots,
              std::optional<Tiling> tiling = {});
  // What it runs. `engine` may be one that is not open yet (EngineOptions::expects).
  static opencl::ProgramRequest program(const opencl::Engine& engine, const FieldOptions& options,
                                        std::optional<Tiling> tiling = {});

  // Pixels of the picture in `slot` outside this disc carry no weight when it is a window's first
  // frame; a window with less than half of its pixels inside is masked. An infinite radius, the
  // default, takes the disc away.
  void set_disc(int slot, double cx_px, double cy_px, double radius_px);

  // Refines the first `count` windows in place: in_out holds the seeds (u, v; the rotation is the
  // window's guess_rot_rad). Windows whose seed is not ok stay as they are. Enqueues only.
  void refine(DeviceFrames& frames, const opencl::Buffer<Window>& windows, std::size_t count,
              opencl::Buffer<WindowMotion>& in_out);

 private:
  opencl::Engine& engine_;
  FieldOptions options_;
  Tiling tiling_;
  cl::Kernel kernel_;
  std::vector<cl_float4> discs_;
  opencl::Buffer<cl_float4> device_discs_;
  bool discs_changed_ = true;
  cl_float4 noise_;
  opencl::Settled settled_{engine_};  // destroyed first: `discs_` may still be on their way
};

}  // namespace impactdic::dic
