// The frames of DeviceFrames as B-splines on the device: coefficients, and value and slopes at the
// pixels. Worked out when first asked for.
#pragma once

#include <optional>
#include <vector>

#include "host/dic/device_frames.h"

namespace impactdic {

// How kernels that work on pictures are shared out on this device.
struct Tiling {
  int vector = 1;  // pixels of a row in one work-item
  int group = 32;  // work-items of a task
};
// The tiling asked for; without one, `group_on_gpu` work-items on a GPU (at most what the device
// takes), and vectors as wide as the SIMD unit in single work-items on a CPU.
// Throws InvalidArgument unless the vector is 1, 4, 8 or 16 and the group a power of two.
Tiling choose_tiling(const Engine& engine, std::optional<Tiling> asked, int group_on_gpu);

class SplineFrames {
 public:
  // Throws InvalidArgument as check_spline does.
  SplineFrames(Engine& engine, int degree, double presmooth_sigma_px, int slots,
               std::optional<Tiling> tiling = {});

  // Says that the picture in `slot` is a new one (or that there is one at all).
  void frame_changed(int slot);
  // Brings all changed slots up to date; `frames` holds their pictures. Enqueues only.
  void prepare(const DeviceFrames& frames);

  int degree() const { return degree_; }
  double presmooth_sigma_px() const { return presmooth_sigma_px_; }
  int slots() const { return static_cast<int>(changed_.size()); }
  int width() const { return width_; }
  int height() const { return height_; }
  // (slots, height + 2·SPLINE_PAD, pitch()) from coefficient_offset() on; before and behind are
  // zeros that vectors may touch.
  const Buffer<float>& coefficients() const { return coefficients_; }
  int pitch() const { return pitch_; }
  int coefficient_offset() const { return kGuardRows * pitch_; }
  // (slots, 3, height, plane_pitch()): value, ∂/∂x, ∂/∂y of the spline at the pixels.
  const Buffer<float>& planes() const { return planes_; }
  int plane_pitch() const { return plane_pitch_; }

 private:
  // A vector's idle lanes may be turned out of the picture by as many rows as it has lanes.
  static constexpr int kGuardRows = 32;
  void allocate(const DeviceFrames& frames);
  void launch(const DeviceFrames& frames, const std::vector<int>& slots);

  Engine& engine_;
  int degree_;
  double presmooth_sigma_px_;
  Tiling tiling_;
  int radius_ = 0;
  int width_ = 0, height_ = 0, pitch_ = 0, plane_pitch_ = 0;
  std::vector<bool> changed_;
  cl::Kernel rows_kernel_, columns_kernel_, gradients_kernel_;
  Buffer<float> taps_, rows_, coefficients_, planes_;
  Buffer<cl_int> batch_;
};

}  // namespace impactdic
