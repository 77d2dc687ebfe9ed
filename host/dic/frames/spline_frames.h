// The frames of DeviceFrames as B-splines on the device: coefficients, and value and slopes at the
// pixels. Worked out when first asked for.
#pragma once

#include <optional>
#include <vector>

#include "host/dic/device/tiling.h"
#include "host/dic/frames/device_frames.h"

namespace impactdic::dic {

class SplineFrames {
 public:
  // Throws InvalidArgument as check_spline does.
  SplineFrames(opencl::Engine& engine, int degree, double presmooth_sigma_px, int slots,
               std::optional<Tiling> tiling = {});

  // What works them out. `engine` may be one that is not open yet (EngineOptions::expects).
  static opencl::ProgramRequest program(const opencl::Engine& engine, int degree,
                                        double presmooth_sigma_px,
                                        std::optional<Tiling> tiling = {});

  // Brings the slots into which a picture came since the last call up to date. Enqueues only.
  // DeviceFrames::splines calls it.
  void prepare(const DeviceFrames& frames);
  // Takes all slots as changed.
  void forget() { versions_.assign(versions_.size(), 0); }

  int degree() const { return degree_; }
  int vector() const { return tiling_.vector; }
  double presmooth_sigma_px() const { return presmooth_sigma_px_; }
  int slots() const { return static_cast<int>(versions_.size()); }
  int width() const { return width_; }
  int height() const { return height_; }
  // (slots, height + 2·SPLINE_PAD, pitch()) from coefficient_offset() on; before and behind are
  // zeros that vectors may touch.
  const opencl::Buffer<float>& coefficients() const { return coefficients_; }
  int pitch() const { return pitch_; }
  int coefficient_offset() const { return kGuardRows * pitch_; }
  // (slots, 3, height, plane_pitch()): value, ∂/∂x, ∂/∂y of the spline at the pixels.
  const opencl::Buffer<float>& planes() const { return planes_; }
  int plane_pitch() const { return plane_pitch_; }

 private:
  // A vector's idle lanes may be turned out of the picture by as many rows as it has lanes.
  static constexpr int kGuardRows = 32;
  void allocate(const DeviceFrames& frames);
  void launch(const DeviceFrames& frames, std::size_t first, std::size_t count);

  opencl::Engine& engine_;
  int degree_;
  double presmooth_sigma_px_;
  Tiling tiling_;
  int radius_ = 0;
  int width_ = 0, height_ = 0, pitch_ = 0, plane_pitch_ = 0;
  std::vector<std::uint64_t> versions_;  // of the pictures that the splines are of
  cl::Kernel rows_kernel_, columns_kernel_, gradients_kernel_;
  std::size_t at_once_ = 1;  // frames that are filtered together
  opencl::Buffer<float> taps_, rows_, coefficients_, planes_;
  std::vector<cl_int> changed_;  // slots of the last call
  opencl::Buffer<cl_int> device_changed_;
  opencl::Settled settled_{engine_};  // destroyed first: `changed_` may still be on its way
};

}  // namespace impactdic::dic
